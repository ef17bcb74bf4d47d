// The meaning of merge_row_simd.cpp. Every sum is in the same order and every product rounds alike, so that the two
// agree to the bit on every target.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "libhdr/merge/internal/merge_row.h"

namespace hdr::internal::reference {
namespace {

/// What one shot says of one sample.
struct Observation {
  float exposure = 1;
  float level = -1;  ///< negative: outside the photograph, or shut out
  float weight = 0, weight_light = 0;
  float information = 1, trust = 1;
};

int code_at(const MergeRowTask& task, int shot, int sample) {
  const void* codes = task.shots[shot].codes;
  return task.model->bits <= 8 ? static_cast<const std::uint8_t*>(codes)[sample]
                               : static_cast<const std::uint16_t*>(codes)[sample];
}

/// All shots' observations of channel c of pixel x; a closing code shuts out the shots that follow.
void observe(const MergeRowTask& task, int x, std::size_t c, std::vector<Observation>& out) {
  const ChannelModel& channel = task.model->channel[c];
  bool open = true;
  out.clear();
  for (int j = 0; j < task.count; ++j) {
    Observation o;
    o.exposure = task.shots[j].exposure;
    bool closes = false;
    const auto pixel = static_cast<std::size_t>(x);
    const float* trust = task.shots[j].trust;
    const bool trusted = !trust || trust[pixel] > 0;
    if (const WarpedRow* warped = task.shots[j].warped) {
      closes = warped->closes[c][pixel] != 0;
      o.information = warped->information[c][pixel];
      o.trust = warped->trust[c][pixel];
      if (open && task.model->hat) {
        o.weight = warped->weight[c][pixel];
        o.weight_light = warped->weight_light[c][pixel];
      } else if (open) {
        o.level = warped->level[c][pixel];
      }
    } else {
      const int code = code_at(task, j, 3 * x + static_cast<int>(c));
      closes = code >= task.model->closing_code;
      if (open && task.model->hat) {
        o.weight = channel.weight[static_cast<std::size_t>(code)];
        o.weight_light = channel.weight_light[static_cast<std::size_t>(code)];
      } else if (open) {
        o.level = channel.level[static_cast<std::size_t>(code)];
      }
    }
    if (trust) {
      o.trust *= trust[pixel];
      o.weight *= trust[pixel];
      o.weight_light *= trust[pixel];
      if (!trusted) o.level = -1;
    }
    open = open && !(closes && trusted);
    out.push_back(o);
  }
}

float precision_at(const ChannelModel& channel, float level) {
  const std::int32_t bin = (static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(level)) >> PrecisionTable::kShift) -
                           PrecisionTable::kFirst;
  return channel.precision.values[static_cast<std::size_t>(std::clamp(bin, 0, PrecisionTable::kBins - 1))];
}

std::size_t censoring_bin(float z) {
  const float bin = (z + CensoringTable::kReach) * CensoringTable::kBinsPerDeviation;
  return static_cast<std::size_t>(std::clamp(bin, 0.0f, static_cast<float>(CensoringTable::kBins - 1)));
}

struct Estimate {
  float value = 0, precision = 0;
  float spread = 0;       ///< the precisions times their trust: of a weighted mean that is the variance's numerator
  bool censored = false;  ///< a shot near one of its bounds took part
};

/// One step of Fisher's scoring [Fisher25] from radiance `radiance` (in levels at H = 1).
Estimate score(const ChannelModel& m, const std::vector<Observation>& shots, float radiance, float floor) {
  const CensoringTable& table = censoring_table();
  float sum = 0, total = 0;
  Estimate estimate;
  for (std::size_t j = shots.size(); j-- > 0;) {
    const float H = shots[j].exposure, level = shots[j].level;
    const float expected = radiance * H;
    if (expected > m.beyond_clip) continue;  // clipped for certain
    const float per_level = precision_at(m, expected) * shots[j].information, trust = shots[j].trust;
    const float precision = per_level * trust * H;
    const bool clipped = level >= m.clip_bound, black = level <= m.black_bound;
    const bool near_clip = expected >= m.near_clip, near = near_clip || expected <= m.near_black;
    float information = 1, term = level;
    if (near) {
      const float inverse = std::sqrt(per_level), deviation = 1 / inverse;
      const std::size_t to_clip = censoring_bin((m.clip_bound - expected) * inverse);
      const std::size_t to_black = censoring_bin((expected - m.black_bound) * inverse);
      information = std::max(0.0f, table.information[to_clip] + table.information[to_black] - 1);
      const float excess = clipped ? deviation * table.excess[to_clip]
                           : black ? 0 - deviation * table.excess[to_black]
                                   : level - expected;
      term = information * expected + excess;
    }
    const float weight = precision * H * information;
    // A shot that adds less than 1/256 of what longer ones gave is left out, with all that are shorter.
    if (!near_clip && weight * 256 < total * trust) break;
    if (level < 0 || (!near && (clipped || black))) continue;
    sum += precision * term;
    total += weight;
    estimate.spread += weight * trust;
    estimate.censored = estimate.censored || near;
  }
  estimate.value = std::max(floor, sum / std::max(total, std::numeric_limits<float>::min()));
  estimate.precision = total;
  return estimate;
}

/// The longest shot that is safely below clipping; where there is none, or it is black, the shortest that is close to
/// clipping; else the shortest that shows the sample.
float first_guess(const ChannelModel& m, const std::vector<Observation>& shots) {
  float radiance = 0, bright = -1;
  bool safe = false, black = false;
  for (std::size_t j = shots.size(); j-- > 0;) {
    const float level = shots[j].level;
    if (level < 0) continue;
    if (level > m.near_clip && level > m.black_bound && level < m.clip_bound) bright = level * (1 / shots[j].exposure);
    if (safe) continue;
    radiance = level * (1 / shots[j].exposure);
    safe = level <= m.near_clip;
    black = level <= m.black_bound;
  }
  return (!safe || black) && bright >= 0 ? bright : radiance;
}

bool measured(const ChannelModel& m, const std::vector<Observation>& shots) {
  return std::any_of(shots.begin(), shots.end(),
                     [&](const Observation& o) { return o.level > m.black_bound && o.level < m.clip_bound; });
}

/// Censored observations are not linear in the radiance: where one took part the step is repeated.
constexpr int kSteps = 3;

void merge_sample_by_likelihood(const MergeRowTask& task, const std::vector<Observation>& shots, std::size_t sample) {
  const ChannelModel& m = task.model->channel[sample % 3];
  if (!measured(m, shots)) {
    task.unmeasured[sample] = 1;
    return;
  }
  const float floor = m.dark * (1 / shots.back().exposure);
  Estimate estimate = score(m, shots, first_guess(m, shots), floor);
  for (int step = 1; step < kSteps && estimate.censored; ++step) estimate = score(m, shots, estimate.value, floor);
  if (!(estimate.precision > 0)) {
    task.unmeasured[sample] = 1;
    return;
  }
  task.rgb[sample] = estimate.value * m.saturation;
  if (task.stddev) {
    task.stddev[sample] =
        m.saturation / std::sqrt(estimate.precision) * std::sqrt(estimate.spread / estimate.precision);
  }
}

void merge_sample_by_hat(const MergeRowTask& task, const std::vector<Observation>& shots, std::size_t sample) {
  const ChannelModel& m = task.model->channel[sample % 3];
  float sum = 0, total = 0;
  for (const Observation& o : shots) {
    sum += o.weight_light;
    total += o.weight * o.exposure;
  }
  if (!(total > 0)) {
    task.unmeasured[sample] = 1;
    return;
  }
  task.rgb[sample] = sum / total;
  if (!task.stddev) return;
  const float radiance = task.rgb[sample] * (1 / m.saturation);
  float variance = 0;
  for (const Observation& o : shots) {
    variance += o.weight * o.weight / (precision_at(m, radiance * o.exposure) * o.information);
  }
  task.stddev[sample] = m.saturation * std::sqrt(variance) / total;
}

}  // namespace

void merge_row(const MergeRowTask& task) {
  const std::size_t samples = 3 * static_cast<std::size_t>(task.width);
  std::fill_n(task.rgb, samples, 0.0f);
  if (task.stddev) std::fill_n(task.stddev, samples, 0.0f);
  std::fill_n(task.unmeasured, samples, std::uint8_t{0});
  std::vector<Observation> shots;
  for (std::size_t sample = 0; sample < samples; ++sample) {
    observe(task, static_cast<int>(sample / 3), sample % 3, shots);
    if (task.model->hat) {
      merge_sample_by_hat(task, shots, sample);
    } else {
      merge_sample_by_likelihood(task, shots, sample);
    }
  }
}

}  // namespace hdr::internal::reference
