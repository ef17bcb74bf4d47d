#include "libhdr/merge/internal/merge_model.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "libhdr/core/error.h"
#include "libhdr/merge/weight.h"

namespace hdr::internal {
namespace {

/// Levels are floats: closer than this to each other they are the same (and no variance is zero).
constexpr double kLevelResolution = 0x1p-24;

/// Variance of a level, in shares of saturation.
class LevelVariance {
 public:
  LevelVariance(const Response& response, int channel, const NoiseModel& noise, const BlackPoint& black, double range)
      : response_(response), channel_(channel), noise_(noise), black_(black), range_(range) {}
  double operator()(double level) const {
    const double variance = exposure_variance(response_, channel_, noise_, level * range_ + black_.offset);
    return std::max(variance / (range_ * range_), kLevelResolution * kLevelResolution);
  }

 private:
  const Response& response_;
  int channel_;
  NoiseModel noise_;
  BlackPoint black_;
  double range_;
};

/// The level in the middle of a bin.
float level_of_bin(std::int32_t bin) {
  const auto bits = static_cast<std::uint32_t>(PrecisionTable::kFirst + bin) << PrecisionTable::kShift;
  return std::bit_cast<float>(bits + (1u << (PrecisionTable::kShift - 1)));
}

PrecisionTable precision_table(const LevelVariance& variance) {
  PrecisionTable table;
  for (std::int32_t bin = 0; bin < PrecisionTable::kBins; ++bin) {
    table.values.push_back(static_cast<float>(1 / variance(level_of_bin(bin))));
  }
  return table;
}

/// The level whose distance from `bound` is kReach of its own deviations, above (sign 1) or below (-1) the bound.
double reach(const LevelVariance& variance, double bound, int sign) {
  const double deviations = CensoringTable::kReach;
  if (sign < 0) {
    double low = 0, high = bound;  // the distance falls and the deviation rises with the level
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      (bound - middle > deviations * std::sqrt(variance(middle)) ? low : high) = middle;
    }
    return low;
  }
  double low = bound, high = bound + 1;
  while (high - bound < deviations * std::sqrt(variance(high)) && high < 1e6) high *= 2;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (middle - bound < deviations * std::sqrt(variance(middle)) ? low : high) = middle;
  }
  return high;
}

/// [Debevec97] eq. 4 of the code that stands for the level, its peak at 1.
std::vector<float> hats_of_levels(const ChannelModel& model, std::size_t codes) {
  std::vector<float> hats;
  std::size_t code = 0;
  const auto black = static_cast<double>(model.black_code), range = static_cast<double>(codes) - 1 - black;
  for (std::int32_t bin = 0; bin < PrecisionTable::kBins; ++bin) {
    while (code + 1 < codes && model.level[code] < level_of_bin(bin)) ++code;
    const double value = (static_cast<double>(code) - black) / range;
    hats.push_back(static_cast<float>(std::max(0.0, 1 - std::abs(2 * value - 1))));
  }
  return hats;
}

/// The hat's weights at levels between those of the codes: linear from code to code, between the first that is light
/// and the last that is not clipped.
std::vector<float> weights_of_levels(const ChannelModel& model, std::size_t clipped) {
  const auto first = static_cast<std::size_t>(model.black_code) + 1;
  std::vector<float> weights;
  std::size_t above = first;
  for (std::int32_t bin = 0; bin < PrecisionTable::kBins; ++bin) {
    const float level = level_of_bin(bin);
    while (above < clipped && model.level[above] < level) ++above;
    if (above == first || above >= clipped) {
      weights.push_back(model.weight[std::min(above, clipped - 1)]);
      continue;
    }
    const float below_level = model.level[above - 1], step = model.level[above] - below_level;
    const float t = step > 0 ? std::clamp((level - below_level) / step, 0.0f, 1.0f) : 1;
    weights.push_back((1 - t) * model.weight[above - 1] + t * model.weight[above]);
  }
  return weights;
}

ChannelModel channel_model(const Response& response, int channel, const MergeModelOptions& options) {
  const BlackPoint black = black_point(response, channel, options.black_level);
  const std::vector<double> light = light_table(response, channel, black);
  const double range = light.back();
  if (!(range > 0)) {
    throw Error("--black-level: leaves no light in channel " + std::to_string(channel) +
                "; give a code under the brightest");
  }
  const int clipped = first_clipped_code(response.bits, options.lossy);
  const auto c = static_cast<std::size_t>(channel);
  const LevelVariance variance(response, channel, options.noise[c], black, range);
  // Codes that the depth does not allow are met all the same in damaged files: they count as the largest.
  const int max_code = static_cast<int>(light.size()) - 1, table_size = response.bits <= 8 ? 256 : 65536;
  ChannelModel model;
  model.saturation = static_cast<float>(range);
  model.black_code = black.black_code;
  const auto level_at = [&](double code) { return (response.exposure(channel, code) - black.offset) / range; };
  const double black_bound = std::max(0.0, level_at(black.black_code + 0.5)), clip_bound = level_at(clipped - 0.5);
  model.black_bound = static_cast<float>(black_bound);
  model.clip_bound = std::max(static_cast<float>(clip_bound), std::nextafter(model.black_bound, 2.0f));
  for (int code = 0; code < table_size; ++code) {
    const auto level = static_cast<float>(light[static_cast<std::size_t>(std::min(code, max_code))] / range);
    // Where the curve is flat a code and its bound coincide: the code decides on which side it is.
    const float above_black = std::nextafter(model.black_bound, 2.0f),
                below_clip = std::nextafter(model.clip_bound, 0.0f);
    model.level.push_back(code <= black.black_code ? std::min(level, model.black_bound)
                          : code >= clipped        ? std::max(level, model.clip_bound)
                                                   : std::clamp(level, above_black, std::max(above_black, below_clip)));
  }
  model.precision = precision_table(variance);
  model.hat_of_level = hats_of_levels(model, light.size());
  model.near_black = static_cast<float>(reach(variance, black_bound, 1));
  model.near_clip = static_cast<float>(reach(variance, clip_bound, -1));
  model.beyond_clip = static_cast<float>(reach(variance, clip_bound, 1));
  model.safe_code = static_cast<int>(std::upper_bound(model.level.begin(), model.level.end(), model.near_clip) -
                                     model.level.begin()) -
                    1;
  model.dark = static_cast<float>(light[static_cast<std::size_t>(black.black_code)] / range);
  if (options.hat()) {
    model.weight = hat_weights(response, channel, options.lossy, options.hat_noise[c], black);
    model.weight.resize(static_cast<std::size_t>(table_size));
    for (std::size_t code = 0; code < light.size(); ++code) {
      model.weight_light.push_back(model.weight[code] * static_cast<float>(light[code]));
    }
    model.weight_light.resize(static_cast<std::size_t>(table_size));
    model.weight_of_level = weights_of_levels(model, static_cast<std::size_t>(clipped));
  }
  return model;
}

}  // namespace

const CensoringTable& censoring_table() {
  static const CensoringTable table = [] {
    CensoringTable t;
    for (std::int32_t bin = 0; bin < CensoringTable::kBins; ++bin) {
      const double z = bin / CensoringTable::kBinsPerDeviation - CensoringTable::kReach;
      const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
      const double inside = 0.5 * std::erfc(-z / std::numbers::sqrt2),
                   beyond = 0.5 * std::erfc(z / std::numbers::sqrt2);
      t.excess[static_cast<std::size_t>(bin)] = static_cast<float>(density / beyond);
      t.information[static_cast<std::size_t>(bin)] =
          static_cast<float>(inside - z * density + density * density / beyond);
    }
    return t;
  }();
  return table;
}

MergeModel make_merge_model(const Response& response, const MergeModelOptions& options) {
  MergeModel model;
  model.bits = response.bits;
  model.lossy = options.lossy;
  model.hat = options.hat();
  model.clipped_code = first_clipped_code(response.bits, options.lossy);
  if (options.lossy) model.closing_code = model.clipped_code;
  for (int channel = 0; channel < 3; ++channel) {
    model.channel[static_cast<std::size_t>(channel)] = channel_model(response, channel, options);
  }
  return model;
}

}  // namespace hdr::internal
