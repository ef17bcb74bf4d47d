#include "libhdr/response/expose.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"

namespace hdr {
namespace {

/// The code of a level, exactly: the number of thresholds that do not exceed it. The leading bits of the float pick a
/// bucket whose first code is known; from there it is a step or two.
class CodeFromLevel {
 public:
  explicit CodeFromLevel(const std::vector<double>& thresholds, int bits)
      : shift_(23 - std::min(bits, 12)), thresholds_(thresholds.size() + 1) {
    // Levels are compared as floats; the guard at the end keeps the search inside.
    for (std::size_t k = 0; k < thresholds.size(); ++k) thresholds_[k] = static_cast<float>(thresholds[k]);
    thresholds_.back() = std::numeric_limits<float>::infinity();
    const std::uint32_t buckets = (std::bit_cast<std::uint32_t>(1.0f) >> shift_) + 1;
    first_code_.resize(buckets - kFirstBucketBits / (1u << shift_));
    std::uint32_t code = 0;
    for (std::size_t k = 0; k < first_code_.size(); ++k) {
      const std::uint32_t start = (static_cast<std::uint32_t>(k) << shift_) + kFirstBucketBits;
      while (thresholds_[code] <= std::bit_cast<float>(start)) ++code;
      first_code_[k] = k == 0 ? 0 : code;
    }
  }

  /// `level` in [0, 1].
  std::uint32_t operator()(float level) const {
    const std::uint32_t bits = std::max(std::bit_cast<std::uint32_t>(level), kFirstBucketBits);
    std::uint32_t code = first_code_[(bits - kFirstBucketBits) >> shift_];
    while (level >= thresholds_[code]) ++code;
    return code;
  }

 private:
  static constexpr std::uint32_t kFirstBucketBits = (127u - 40u) << 23;  ///< 2^-40: darker levels share a bucket
  int shift_;
  std::vector<float> thresholds_;
  std::vector<std::uint32_t> first_code_;
};

std::array<CodeFromLevel, 3> codes_from_levels(const Response& response) {
  const auto channel = [&](int c) {
    // Full well is the exposure of the largest code.
    std::vector<double> thresholds = response.exposure_thresholds(c);
    const double full_well = response.exposure(c, std::ldexp(1.0, response.bits) - 1);
    for (double& t : thresholds) t /= full_well;
    return CodeFromLevel(thresholds, response.bits);
  };
  return {channel(0), channel(1), channel(2)};
}

/// Three standard normal numbers, a function of (seed, pixel). Two Box-Muller pairs, of which one number is left over.
std::array<double, 3> pixel_noise(std::uint64_t seed, std::uint64_t pixel) {
  Random random(seed, pixel);
  const double radius0 = std::sqrt(-2 * std::log(1 - random.uniform()));
  const double angle0 = 2 * std::numbers::pi * random.uniform();
  const double radius1 = std::sqrt(-2 * std::log(1 - random.uniform()));
  const double angle1 = 2 * std::numbers::pi * random.uniform();
  return {radius0 * std::cos(angle0), radius0 * std::sin(angle0), radius1 * std::cos(angle1)};
}

template <class Code>
Image<Code> expose_codes(View<const float> radiance, double gain, const Sensor& sensor, std::uint64_t seed) {
  const std::array<CodeFromLevel, 3> code_from_level = codes_from_levels(sensor.response);
  Image<Code> codes(radiance.size(), 3);
  for_rows(radiance.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < radiance.width(); ++x) {
        const auto address = static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(radiance.width()) +
                             static_cast<std::uint64_t>(x);
        const std::array<double, 3> noise = pixel_noise(seed, address);
        for (int c = 0; c < 3; ++c) {
          // level = radiance * sensitivity * H; NaN fails the comparison and counts as no light.
          const double light = radiance(x, y, c) * gain;
          const double level = light > 0 ? std::min(light, 1e6) : 0;
          // The well overflows after the photons have arrived with their noise.
          const double noisy = level + sensor.noise.stddev(level) * noise[static_cast<std::size_t>(c)];
          codes(x, y, c) = static_cast<Code>(
              code_from_level[static_cast<std::size_t>(c)](static_cast<float>(std::clamp(noisy, 0.0, 1.0))));
        }
      }
    }
  });
  return codes;
}

int mirrored(int index, int count) {
  const int period = 2 * count;
  index %= period;
  if (index < 0) index += period;
  return index < count ? index : period - 1 - index;
}

}  // namespace

Photo expose(View<const float> radiance, const Exposure& exposure, const Sensor& sensor, std::uint64_t seed) {
  HDR_ASSERT(radiance.channels() == 3);
  HDR_ASSERT(sensor.response.levels() == response_levels(sensor.response.bits));
  const double gain = sensor.sensitivity * exposure.relative().value();
  Photo photo;
  photo.exposure = exposure;
  photo.bits = sensor.response.bits;
  if (photo.bits <= 8) {
    photo.codes = expose_codes<std::uint8_t>(radiance, gain, sensor, seed);
  } else {
    photo.codes = expose_codes<std::uint16_t>(radiance, gain, sensor, seed);
  }
  return photo;
}

Image<float> shake(View<const float> radiance, const Mat3& scene_from_photo) {
  const int width = radiance.width(), height = radiance.height(), channels = radiance.channels();
  Image<float> moved(radiance.size(), channels);
  if (radiance.empty()) return moved;
  const bool still = scene_from_photo.isIdentity(0);
  Image<float> logs(still ? Size{} : radiance.size(), channels);
  for_rows(height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const float* row = radiance.row(y);
      if (still) std::copy(row, row + width * channels, moved.row(y));
      // The smallest normal float stands for no light, whose logarithm does not exist.
      for (int k = 0; k < width * channels && !still; ++k) {
        logs.row(y)[k] =
            std::log(std::clamp(row[k], std::numeric_limits<float>::min(), std::numeric_limits<float>::max()));
      }
    }
  });
  if (still) return moved;
  for_rows(height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < width; ++x) {
        const Vec2 p = (scene_from_photo * Vec3(x, y, 1)).hnormalized();
        const double x0 = std::floor(p.x()), y0 = std::floor(p.y());
        const float u = static_cast<float>(p.x() - x0), v = static_cast<float>(p.y() - y0);
        const int left = mirrored(static_cast<int>(x0), width), right = mirrored(static_cast<int>(x0) + 1, width);
        const int top = mirrored(static_cast<int>(y0), height), bottom = mirrored(static_cast<int>(y0) + 1, height);
        for (int c = 0; c < channels; ++c) {
          const float above = logs(left, top, c) * (1 - u) + logs(right, top, c) * u;
          const float below = logs(left, bottom, c) * (1 - u) + logs(right, bottom, c) * u;
          moved(x, y, c) = std::exp(above * (1 - v) + below * v);
        }
      }
    }
  });
  return moved;
}

}  // namespace hdr
