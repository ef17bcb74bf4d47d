#include "libhdr/merge/internal/ghost_colours.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "libhdr/core/median.h"

namespace hdr::internal {
namespace {

constexpr std::size_t kFewest = 24;        ///< cells behind a median
constexpr float kMostIncomparable = 0.2f;  ///< of a bin's cells
constexpr float kPlain = 4;                ///< deviations of a median
constexpr float kWide = 0.01f;             ///< variance of offsets before anything is known
constexpr float kMostScale = 5;
constexpr float kMostOffset = 0.35f;  ///< of the largest channel
constexpr float kMedianOfNormal = 0.67449f;

/// Half octaves of a positive ratio (its powers of two, split at one and a half), -6 .. 6 around 0.
int half_octaves(float ratio) {
  constexpr int kOne = 127 << 1, kMost = ColourBins::kRatios / 2;
  return std::clamp(static_cast<int>(std::bit_cast<std::uint32_t>(ratio) >> 22) - kOne, -kMost, kMost);
}

float doubt_of(const ColourMedians::Bin& bin) {
  constexpr float kMedianOverMean = 1.57f;  // variance of a median of normal numbers, pi / 2 over that of their mean
  return kMedianOverMean * bin.deviation * bin.deviation / bin.cells;
}

/// Offsets of the bins of a kind: what is typical of them, beyond what their medians' doubt explains. Robust: the few
/// colours of what moved do not count.
class Spread {
 public:
  void add(const ColourMedians::Bin& bin) {
    constexpr float kUsualError = 0.02f;  // medians less certain than this tell little of a spread
    const float doubt = doubt_of(bin), weight = bin.cells / (1 + doubt / (kUsualError * kUsualError));
    sizes_.emplace_back(std::min(std::abs(bin.median), kMostOffset), weight);
    weight_ += weight;
    doubt_ += weight * doubt;
  }
  bool empty() const { return sizes_.empty(); }
  float variance() {
    std::sort(sizes_.begin(), sizes_.end());
    float below = 0, size = 0;
    for (const auto& [next, weight] : sizes_) {
      size = next;
      below += weight;
      if (2 * below >= weight_) break;
    }
    const float deviation = size / kMedianOfNormal;
    return weight_ > 0 ? std::max(0.0f, deviation * deviation - doubt_ / weight_) : 0;
  }

 private:
  std::vector<std::pair<float, float>> sizes_;  ///< and their weights
  float weight_ = 0, doubt_ = 0;
};

/// By kind; of kinds without a colour that of all.
std::array<float, ColourBins::kKinds> spreads_of(const ColourMedians& medians, std::size_t channel) {
  std::array<Spread, ColourBins::kKinds> of_kind;
  Spread of_all;
  for (const ColourMedians::Bin& bin : medians.bins()) {
    of_kind[ColourBins::kind_of(bin.bin, channel)].add(bin);
    of_all.add(bin);
  }
  std::array<float, ColourBins::kKinds> variances{};
  for (std::size_t k = 0; k < variances.size(); ++k) {
    variances[k] = of_kind[k].empty() ? of_all.variance() : of_kind[k].variance();
  }
  return variances;
}

/// The smaller of two offsets; none where their signs differ.
float agreed(float a, float b) {
  if ((a > 0) != (b > 0)) return 0;
  return a > 0 ? std::min(a, b) : std::max(a, b);
}

}  // namespace

std::uint16_t ColourBins::bin_of(const float* levels, bool clipped) {
  constexpr float kLeast = 1e-6f;
  const int octave = octave_of(std::max({levels[0], levels[1], levels[2]}));
  const float green = std::max(kLeast, levels[1]);
  const int red_green = half_octaves(std::max(kLeast, levels[0]) / green) + kRatios / 2;
  const int blue_green = half_octaves(std::max(kLeast, levels[2]) / green) + kRatios / 2;
  const int colour = ((clipped ? kRatios : 0) + red_green) * kRatios + blue_green;
  return static_cast<std::uint16_t>(colour * kOctaves + octave);
}

int ColourBins::octave_of(float level) {
  const int octave = 126 - static_cast<int>(std::bit_cast<std::uint32_t>(std::max(level, 0.0f)) >> 23);
  return std::clamp(octave + 1, 0, kOctaves - 1);
}

std::size_t ColourBins::kind_of(std::size_t bin, std::size_t channel) {
  const auto colour = static_cast<int>(bin / kOctaves), of_red = colour / kRatios;
  const int half_octaves[3] = {of_red % kRatios - kRatios / 2, 0, colour % kRatios - kRatios / 2};
  const int less = (std::max({half_octaves[0], 0, half_octaves[2]}) - half_octaves[channel]) / 2;
  return static_cast<std::size_t>((of_red >= kRatios ? kKinds / 2 : 0) + std::min(less, kKinds / 2 - 1));
}

ColourMedians::ColourMedians(const std::vector<ColourSample>& samples) : index_(ColourBins::kCount) {
  std::vector<std::uint32_t> start(ColourBins::kCount + 1), incomparable(ColourBins::kCount);
  for (const ColourSample& sample : samples) {
    ++(std::isnan(sample.value) ? incomparable[sample.bin] : start[sample.bin + 1]);
  }
  for (std::size_t k = 0; k < ColourBins::kCount; ++k) start[k + 1] += start[k];
  std::vector<float> values(start.back());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (const ColourSample& sample : samples) {
    if (!std::isnan(sample.value)) values[next[sample.bin]++] = sample.value;
  }
  std::vector<float> some;
  for (std::size_t k = 0; k < ColourBins::kCount; ++k) {
    const std::size_t count = start[k + 1] - start[k];
    if (count < kFewest) continue;
    if (static_cast<float>(incomparable[k]) > kMostIncomparable * static_cast<float>(count + incomparable[k])) continue;
    some.assign(values.begin() + start[k], values.begin() + start[k + 1]);
    Bin bin{k, static_cast<float>(count), median_of(some), 0};
    for (float& value : some) value = std::abs(value - bin.median);
    bin.deviation = median_of(some) / kMedianOfNormal;
    bins_.push_back(bin);
    index_[k] = static_cast<std::uint16_t>(bins_.size());
  }
}

ColourMisfit::ColourMisfit(std::size_t channel, const std::vector<ColourSample>& of_a,
                           const std::vector<ColourSample>& of_b)
    : channel_(channel), a_{ColourMedians(of_a), {}, {}}, b_{ColourMedians(of_b), {}, {}} {
  // What moved widens the spread of one side more than that of the other.
  const auto in_a = spreads_of(a_.medians, channel), in_b = spreads_of(b_.medians, channel);
  for (std::size_t k = 0; k < spread_.size(); ++k) spread_[k] = std::min(in_a[k], in_b[k]);
  for (Side* side : {&a_, &b_}) {
    for (const ColourMedians::Bin& bin : side->medians.bins()) {
      // What is plain to see needs no colours like it; what may be chance is as wrong as these are.
      const float doubt = doubt_of(bin), own = bin.median * bin.median > kPlain * kPlain * doubt ? kWide : 0;
      const float spread = std::max(own, spread_[ColourBins::kind_of(bin.bin, channel)]);
      const float share = spread > 0 ? spread / (spread + doubt) : 0;
      const float offset = std::clamp(share * bin.median, -kMostOffset, kMostOffset);
      side->expected.push_back({offset, spread * (1 - share)});
    }
  }
}

void ColourMisfit::find_scales(const std::vector<ColourSample>& of_a, const std::vector<ColourSample>& of_b) {
  a_.scales = ColourMedians(of_a);
  b_.scales = ColourMedians(of_b);
}

float ColourMisfit::scale(std::size_t bin_a, std::size_t bin_b) const {
  const int a = a_.scales.find(bin_a), b = b_.scales.find(bin_b);
  float least = kMostScale;
  if (a >= 0) least = std::min(least, a_.scales.bins()[static_cast<std::size_t>(a)].median / kMedianOfNormal);
  if (b >= 0) least = std::min(least, b_.scales.bins()[static_cast<std::size_t>(b)].median / kMedianOfNormal);
  return a < 0 && b < 0 ? 1 : std::max(1.0f, least);
}

ColourMisfit::Expected ColourMisfit::expected(std::size_t bin_a, std::size_t bin_b) const {
  // Many colours clip to one: what this one was is not known, but for what the other shot shows.
  if (ColourBins::clipped(bin_a) || ColourBins::clipped(bin_b)) {
    const std::size_t kind = ColourBins::kind_of(ColourBins::clipped(bin_a) ? bin_b : bin_a, channel_);
    return {0, std::max(spread_[kind], spread_[kind % (ColourBins::kKinds / 2)])};
  }
  const int a = a_.medians.find(bin_a), b = b_.medians.find(bin_b);
  if (a < 0 && b < 0) return {0, spread_[ColourBins::kind_of(bin_a, channel_)]};
  if (a < 0) return b_.expected[static_cast<std::size_t>(b)];
  const Expected& of_a = a_.expected[static_cast<std::size_t>(a)];
  if (b < 0) return of_a;
  const Expected& of_b = b_.expected[static_cast<std::size_t>(b)];
  return {agreed(of_a.offset, of_b.offset), std::min(of_a.variance, of_b.variance)};
}

}  // namespace hdr::internal
