#pragma once
// What a camera does to colours that no curve by channel explains: matrices that leave the gamut, highlights that fade
// to white. Two shots then differ by what depends on the colour and its level, not on the place.
//
// So it is measured for each colour that a shot shows: the median of the difference of two shots in a channel, as a
// share of the light of the largest channel, which is what colour matrices and gamuts move channels by (of a saturated
// yellow the blue may be anything, though it is wrong by little of its light). A thing that moved shows one colour in
// one shot and another in the other, and is the exception among the cells of one of them; what the camera does to a
// colour holds for most cells of that colour in either shot. Of the two medians the smaller one is believed, and none
// where they contradict each other. The same holds of how far the cells of a colour scatter. Grey stays grey in all of
// this, so that the comparison (ghost_agreement.h) bounds it by the colour's distance from grey.
//
// Colours that few cells show are expected to be as wrong as others are: medians shrink by their doubt towards none,
// and what is left of the spread of colours is the doubt of a comparison [Efron75].
#include <array>
#include <cstdint>
#include <vector>

namespace hdr::internal {

/// Colours in bins: two ratios of channels, by half octaves, the octave of the largest, and whether a channel is
/// clipped.
struct ColourBins {
  static constexpr int kRatios = 13, kOctaves = 20;
  static constexpr std::size_t kCount = 2 * kRatios * kRatios * kOctaves;

  static std::uint16_t bin_of(const float* levels, bool clipped);
  /// 0 for levels from 1 up, then downwards.
  static int octave_of(float level);
  /// Colours of a kind are wrong alike: by how many octaves the channel has less light than the largest, and clipping.
  static constexpr int kKinds = 8;
  static std::size_t kind_of(std::size_t bin, std::size_t channel);
  static bool clipped(std::size_t bin) { return bin >= kCount / 2; }
};

struct ColourSample {
  std::uint16_t bin = 0;
  float value = 0;  ///< NaN: not comparable
};

/// What the cells of each colour of one shot have in common, in one channel.
class ColourMedians {
 public:
  ColourMedians() = default;
  /// Bins of few cells say nothing, nor those of which many cells cannot be compared: the others are a choice.
  explicit ColourMedians(const std::vector<ColourSample>& samples);

  struct Bin {
    std::size_t bin = 0;
    float cells = 0, median = 0;
    float deviation = 0;  ///< robust, of the values
  };
  const std::vector<Bin>& bins() const { return bins_; }
  /// Index of bins(), negative: says nothing.
  int find(std::size_t bin) const { return index_.empty() ? -1 : static_cast<int>(index_[bin]) - 1; }

 private:
  std::vector<std::uint16_t> index_;
  std::vector<Bin> bins_;
};

/// One channel of a pair of shots.
class ColourMisfit {
 public:
  ColourMisfit() = default;
  /// Values are differences; by the colours of both shots.
  ColourMisfit(std::size_t channel, const std::vector<ColourSample>& of_a, const std::vector<ColourSample>& of_b);
  /// Values are sizes of differences, in the deviations that they are expected to have.
  void find_scales(const std::vector<ColourSample>& of_a, const std::vector<ColourSample>& of_b);

  struct Expected {
    float offset = 0;  ///< of a, as a share of the largest channel's light
    float variance = 0;
  };
  Expected expected(std::size_t bin_a, std::size_t bin_b) const;
  /// How much larger differences are than expected, for most cells of the colour; 1 or more.
  float scale(std::size_t bin_a, std::size_t bin_b) const;

 private:
  struct Side {
    ColourMedians medians, scales;
    std::vector<Expected> expected;  ///< by bin of `medians`
  };
  std::size_t channel_ = 0;
  Side a_, b_;
  std::array<float, ColourBins::kKinds> spread_{};  ///< variance of the offsets of a kind
};

}  // namespace hdr::internal
