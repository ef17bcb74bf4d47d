#pragma once
// Do two shots show the same thing in a cell? By the noise model, and by what it does not hold: see PairAgreement.
#include <array>
#include <cstdint>
#include <vector>

#include "libhdr/merge/internal/ghost_cells.h"
#include "libhdr/merge/internal/ghost_colours.h"

namespace hdr::internal {

/// Cells x0 .. x1 - 1 of rows y0 .. y1 - 1.
struct CellBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  std::size_t count() const { return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height()); }
};

/// A shot in cells, with what its comparison needs.
struct CellShot {
  CellPicture picture;
  float exposure = 1;
  float residual_px = 0;              ///< of its registration
  std::vector<std::uint16_t> range;   ///< 3 a cell: largest less smallest level of 3 x 3 cells, upper half of a float
  std::vector<std::uint16_t> colour;  ///< 1 a cell: ColourBins

  void find_range(const CellGrid& grid);
  void find_colours();
  float range_of(std::size_t sample) const;
  bool clipped(std::size_t cell, std::size_t channel) const {
    return picture.flags[cell] & (CellPicture::kClipped << channel);
  }
};

/// Radiances differ by noise (the model's, over the cell's pixels), by the registration's error (a share of the local
/// range that both shots show), by what the response has wrong (a median ratio for each octave of level, up to 40 %, is
/// taken out; per cents stay, more of them towards the ends of the codes where the merge doubts these), by what the
/// camera does to colours, the more the farther they are from grey (ghost_colours.h), and by whatever the shots
/// themselves show most cells to differ by: a median size above the model's scales it. What is left over is a thing
/// that moved.
///
/// Near white colours pale: sensors clip each channel before a matrix mixes them, curves fade to white. How much
/// depends on the colour, and cells of one colour are too few to tell. So the longer shot is asked at each brightness
/// that the shorter one predicts for it: where more than a few of its lesser channels have more light than predicted,
/// though no more than the largest, they say nothing there but that they are between the two.
class PairAgreement {
 public:
  /// `a` has the shorter exposure. All must outlive it.
  PairAgreement(const CellGrid& grid, const MergeModel& model, const CellShot& a, const CellShot& b);

  /// In deviations, 1/16 each, 255 at most: the larger of a cell's own difference and that of the mean of 3 x 3 cells.
  /// Raises `out` (row by row, over the box) where it is less.
  void raise(const CellBox& box, std::vector<std::uint8_t>& out) const;
  static constexpr float kUnit = 16;

  /// Raises to `value` where the cells around have texture in both shots, and not the same.
  void raise_by_texture(const CellBox& box, std::uint8_t value, std::vector<std::uint8_t>& out) const;

 private:
  struct Rows;
  struct Difference {
    float value = 0, noise = 0, other = 0;  ///< and variances
    float shift = 0;                        ///< what the registration may have wrong, a part of `other`
  };
  std::array<float, 3> doubt_at(const std::array<float, 3>& level) const;
  std::array<float, 3> doubts(const CellShot& shot, const CellShot& other, const std::array<float, 3>& factor,
                              std::size_t cell) const;
  /// Of the three channels; no noise: not comparable.
  void differences(std::size_t cell, Difference* out) const;
  /// Visits the cells that medians look at.
  template <class Visit>
  void for_some(const Visit& visit) const;
  void find_corrections();
  void find_colours();
  int find_paling() const;
  void find_scales_of_colours();
  void find_scale();
  /// The light of both shots, response's corrections included, and of the largest channel.
  struct Light {
    std::array<float, 3> a, b;
    float largest = 0;
    std::array<float, 3> paler;  ///< how much more light than in a the channel has when no colour is left
    int brightness = 0;          ///< that b has to show, in bins
    float chroma = 0;  ///< 0 grey, 1 at the edge of the gamut; the less of both shots, where both show the colour
  };
  Light light_of(std::size_t cell) const;
  float correction_of(std::size_t cell, std::size_t channel) const {
    return correction_[channel][static_cast<std::size_t>(ColourBins::octave_of(a_.picture.level[3 * cell + channel]))];
  }

  static constexpr int kBrightness = 16;
  static int brightness_bin(float level);
  int pales_from_ = kBrightness;  ///< brightness from which the camera makes colours paler

  static constexpr int kOctaves = ColourBins::kOctaves;
  const CellGrid& grid_;
  const MergeModel& model_;
  const CellShot &a_, &b_;
  float pixels_, registration_, scale_ = 1;
  std::array<std::array<float, kOctaves>, 3> correction_{};  ///< factor on b, by channel and octave of a's level
  std::array<ColourMisfit, 3> misfit_;                       ///< beyond that
};

}  // namespace hdr::internal
