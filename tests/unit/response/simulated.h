#pragma once
// Brackets with known truth.
#include <cmath>
#include <vector>

#include "libhdr/response/expose.h"
#include "tests/support/support.h"

namespace hdr::test {

inline Exposure shutter(double seconds) {
  Exposure exposure;
  exposure.seconds = seconds;
  return exposure;
}

struct Simulation {
  int width = 450, height = 300;
  double scene_stops = 10;
  std::vector<double> evs = {-6, -4, -2, 0, 0.67, 2, 4, 6};
  NoiseModel noise;
  std::uint64_t seed = 1;
};

inline Bracket simulate(const Response& response, const Simulation& s, const std::vector<Mat3>& scene_from_photo = {}) {
  const Image<float> scene = test_scene(s.width, s.height, s.scene_stops, s.seed);
  const Sensor sensor{response, s.noise, 0.18};  // radiance 1, the median, at 18 % of full well when H = 1
  Bracket bracket;
  for (std::size_t j = 0; j < s.evs.size(); ++j) {
    const Exposure exposure = shutter(std::exp2(s.evs[j]));
    Photo photo = scene_from_photo.empty()
                      ? expose(scene, exposure, sensor, s.seed * 100 + j)
                      : expose(shake(scene, scene_from_photo[j]), exposure, sensor, s.seed * 100 + j);
    photo.path = "shot" + std::to_string(j) + ".png";
    bracket.shots.push_back(std::move(photo));
    bracket.input_order.push_back(static_cast<int>(j));
  }
  return bracket;
}

/// Rms of g - truth in natural logs over 8-bit codes 5..250 (or the same part of deeper ones), its mean removed: that
/// is only the white balance.
inline double rms_error(const Response& fitted, const Response& truth, int channel) {
  double sum = 0, squares = 0, count = 0;
  const int step = truth.levels() / 256;
  for (int level = 5 * step; level <= 250 * step; ++level) {
    const double e = fitted.g[static_cast<std::size_t>(channel)][static_cast<std::size_t>(level)] -
                     truth.g[static_cast<std::size_t>(channel)][static_cast<std::size_t>(level)];
    sum += e;
    squares += e * e;
    ++count;
  }
  return std::sqrt(std::max(0.0, squares / count - sum * sum / (count * count)));
}

}  // namespace hdr::test
