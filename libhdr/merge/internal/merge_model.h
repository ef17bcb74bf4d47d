#pragma once
// What the kernels know of the camera: tables by code, and by level for the variance. Levels are light as a share of
// what saturates the channel: 1 is the light of the largest code.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include "libhdr/merge/merge.h"

namespace hdr::internal {

/// 1 / variance of a level, by the leading bits of the predicted level: 32 bins an octave, over 2^-27 .. 2.
struct PrecisionTable {
  static constexpr int kShift = 23 - 5;                                ///< bits of a float that a bin has no use for
  static constexpr std::int32_t kFirst = (127 - 27) << (23 - kShift);  ///< bin of 2^-27
  static constexpr std::int32_t kBins = 28 << (23 - kShift);
  std::vector<float> values;

  static std::size_t bin_of(float level) {
    const std::int32_t bin = (std::bit_cast<std::int32_t>(level) >> kShift) - kFirst;
    return static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1));
  }
  float at(float level) const { return values[bin_of(level)]; }
};

/// Normal distribution cut off at a bound, z deviations inside of it [Tobin58]: what an observation tells of the mean,
/// as a share of what it would without the cut, and the mean excess of what lies beyond, in deviations. Bins of 1/32
/// over -4 .. 4; beyond, all (z > 4) or nothing (z < -4).
struct CensoringTable {
  static constexpr float kReach = 4;
  static constexpr float kBinsPerDeviation = 32;
  static constexpr std::int32_t kBins = 257;
  std::array<float, kBins> information, excess;
};
const CensoringTable& censoring_table();

struct ChannelModel {
  float saturation = 1;  ///< light of the largest code: radiance = level * saturation / H
  int black_code = 0;    ///< up to here: no light

  // Maximum likelihood.
  std::vector<float> level;  ///< by code
  PrecisionTable precision;
  int safe_code = 0;      ///< the last code whose level does not exceed near_clip
  float black_bound = 0;  ///< level under which the code is black
  float clip_bound = 1;   ///< level from which the code is clipped
  /// Outside of these no noise that matters takes a level across a bound: kReach deviations of it.
  float near_black = 0, near_clip = 1, beyond_clip = 1;
  float dark = 0;  ///< the level that black stands for

  std::vector<float> hat_of_level;  ///< 1 for a middle code, 0 for black and clipped ones; bins as in PrecisionTable

  // Hat.
  std::vector<float> weight;           ///< by code
  std::vector<float> weight_light;     ///< weight times light
  std::vector<float> weight_of_level;  ///< between the codes, by bins of the level as in PrecisionTable
};

struct MergeModel {
  int bits = 8;
  bool hat = false;
  bool lossy = false;
  bool distrusts_ends = false;  ///< for comparisons: what hat says of the bracket's merge
  int clipped_code = 255;       ///< from here up: any amount of light
  /// Only lossy codes contradict a shorter shot that clips; in others it is a thing that moved, or a painted border. So
  /// a sample at or above this code shuts out the longer shots: what clips a shot clips every longer one, and a code
  /// there that says otherwise is JPEG's smear.
  int closing_code = 1 << 16;
  std::array<ChannelModel, 3> channel;
};

struct MergeModelOptions {
  bool lossy = false;  ///< a shot is
  WeightKind kind = WeightKind::kAuto;
  std::optional<double> black_level;
  Noise hat_noise;  ///< in the weights of the hat
  Noise noise;      ///< in those of maximum likelihood, and in standard deviations

  bool hat() const { return kind == WeightKind::kHat || (kind == WeightKind::kAuto && lossy); }
};

MergeModel make_merge_model(const Response& response, const MergeModelOptions& options);

}  // namespace hdr::internal
