#pragma once
// A shot on the map's grid: each sample of the map is one mean of the shot's linear light, whatever the homography.
#include <array>
#include <vector>

#include "libhdr/core/rows.h"
#include "libhdr/core/vec.h"
#include "libhdr/merge/internal/merge_model.h"
#include "libhdr/merge/internal/merge_row.h"

namespace hdr::internal {

/// Pixels x0 .. x1 - 1 of rows y0 .. y1 - 1 of the map.
struct Block {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Cubic convolution with a = -1/2 [Keys81] of levels: it reproduces parabolas and keeps texture that bilinear shares
/// blur, and it stays within the 16 values it is made of, so that nothing rings dark around a lamp. Where one of the 16
/// is clipped or black, whose light is a bound, the four nearest take over; and where one of these is clipped, the
/// others speak for it, but are believed 1/10000 only: shorter shots know better.
///
/// Noise is independent from pixel to pixel in lossless shots, so a mean of several has less of it: `information` of
/// the row says how much less. Trust falls smoothly to 1/1000 over the last 16 pixels (or a twentieth of the shorter
/// side) before the photograph's border, so that no seam shows where a shot ends.
class Resampler {
 public:
  /// `model` must outlive it.
  Resampler(const MergeModel& model, const Mat3& photo_from_ref, Size size)
      : model_(model), photo_from_ref_(photo_from_ref), size_(size) {}

  /// Where pixel (x, y) of the map falls; false: outside. A pixel reaches half a pixel beyond its centre; NaN and
  /// points behind the camera fail the test.
  bool position(int x, int y, Vec2& out) const;

  /// Memory of a thread for any number of blocks.
  struct Patch {
    int left = 0, top = 0, width = 0, height = 0;  ///< in pixels of the photograph
    std::array<std::vector<float>, 3> level;
  };
  /// Column k of rows[r] becomes pixel (block.x0 + k, block.y0 + r) of the map. `codes` has the rows of the photograph
  /// from `first_row` on that the block needs.
  void warp(const CodesView& codes, int first_row, const Block& block, Patch& patch,
            std::vector<WarpedRow>& rows) const;

 private:
  struct Taps;
  bool patch_of(const Block& block, Patch& patch) const;
  void warp_part(const CodesView& codes, int first_row, const Block& whole, const Block& part, Patch& patch,
                 std::vector<WarpedRow>& rows) const;
  void warp_pixel(const Patch& patch, const Vec2& p, std::size_t column, WarpedRow& out) const;
  float border_trust(const Vec2& p) const;

  const MergeModel& model_;
  Mat3 photo_from_ref_;
  Size size_;
};

}  // namespace hdr::internal
