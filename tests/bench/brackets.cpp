#include "tests/bench/brackets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/filter/resize.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "libhdr/response/expose.h"
#include "tests/support/scene.h"

namespace hdr::bench {
namespace {

constexpr int kCoarser = 8;            // how much smaller the scene is made before it is interpolated
constexpr double kMiddleLevel = 0.18;  // of the median, in the middle shot
constexpr double kMiddleSeconds = 1.0 / 64;
constexpr double kTexture = 0.25;  // standard deviation of ln radiance, as plaster and foliage have it

float smoothly(float a, float b, float t) {
  return a + (b - a) * t;
}

/// Noise at the corners of a lattice of `cell` pixels, -1 .. 1.
float lattice(std::uint64_t seed, int octave, int x, int y) {
  const std::uint64_t h = hash64(seed ^ hash64(static_cast<std::uint64_t>(octave) << 56 ^
                                               static_cast<std::uint64_t>(y) << 28 ^ static_cast<std::uint64_t>(x)));
  return static_cast<float>(h >> 40) * 0x1p-23f - 1;
}

/// Adds one octave of value noise to a row.
void add_octave(std::vector<float>& row, int y, int octave, int cell, float amplitude, std::uint64_t seed) {
  const int v = y / cell;
  const float t = static_cast<float>(y % cell) / static_cast<float>(cell);
  float right = 0;
  for (int x0 = 0; x0 < static_cast<int>(row.size()); x0 += cell) {
    const int u = x0 / cell;
    const float left = x0 == 0 ? smoothly(lattice(seed, octave, u, v), lattice(seed, octave, u, v + 1), t) : right;
    right = smoothly(lattice(seed, octave, u + 1, v), lattice(seed, octave, u + 1, v + 1), t);
    const int end = std::min(static_cast<int>(row.size()), x0 + cell);
    for (int x = x0; x < end; ++x) {
      const float s = static_cast<float>(x - x0) / static_cast<float>(cell);
      row[static_cast<std::size_t>(x)] += amplitude * smoothly(left, right, s);
    }
  }
}

/// ln of fractal texture: octaves of 64, 32 ... 2 pixels, each three quarters of the one before. A lens blurs finer
/// ones.
void texture_row(std::vector<float>& row, int y, std::uint64_t seed) {
  std::fill(row.begin(), row.end(), 0.0f);
  constexpr int kOctaves = 6;
  double squares = 0;
  for (int k = 0; k < kOctaves; ++k) squares += std::pow(0.75, 2 * k);
  // The mean square of the interpolated lattice is (2/3)^2 of a corner's third.
  const double unit = kTexture / std::sqrt(squares * 4.0 / 27.0);
  for (int k = 0; k < kOctaves; ++k) {
    add_octave(row, y, k, 64 >> k, static_cast<float>(unit * std::pow(0.75, k)), seed);
  }
}

struct Lamp {
  double x, y, radius, ln_radiance;
};

std::vector<Lamp> lamps_of(Size size, std::uint64_t seed) {
  Random random(seed, 0x1a3b);
  std::vector<Lamp> lamps;
  for (int k = 0; k < 3; ++k) {
    const double x = size.width * (0.1 + 0.8 * random.uniform()), y = size.height * (0.1 + 0.8 * random.uniform());
    lamps.push_back({x, y, 0.015 * size.height, std::log(4096.0) + random.uniform()});
  }
  return lamps;
}

}  // namespace

Image<float> textured_scene(Size size, std::uint64_t seed) {
  const Size coarse_size{size.width / kCoarser + 2, size.height / kCoarser + 2};
  Image<float> coarse = test::test_scene(coarse_size.width, coarse_size.height, 8, seed);
  for (int y = 0; y < coarse.height(); ++y) {
    for (float* v = coarse.row(y); v != coarse.row(y) + coarse.row_samples(); ++v) *v = std::log(*v);
  }
  const std::vector<Lamp> lamps = lamps_of(size, seed);
  Image<float> scene(size, 3);
  for_rows(size.height, 16, [&](int first, int last) {
    std::vector<float> texture(static_cast<std::size_t>(size.width));
    for (int y = first; y < last; ++y) {
      texture_row(texture, y, seed);
      const int v = y / kCoarser;
      const float t = static_cast<float>(y % kCoarser) / kCoarser;
      for (int x = 0; x < size.width; ++x) {
        const int u = x / kCoarser;
        const float s = static_cast<float>(x % kCoarser) / kCoarser;
        double lamp = -1e9;
        for (const Lamp& l : lamps) {
          if (std::hypot(x - l.x, y - l.y) < l.radius) lamp = l.ln_radiance;
        }
        for (int c = 0; c < 3; ++c) {
          const float top = smoothly(coarse(u, v, c), coarse(u + 1, v, c), s);
          const float bottom = smoothly(coarse(u, v + 1, c), coarse(u + 1, v + 1, c), s);
          const double ln = smoothly(top, bottom, t) + texture[static_cast<std::size_t>(x)];
          scene(x, y, c) = static_cast<float>(std::exp(std::max(ln, lamp)));
        }
      }
    }
  });
  return scene;
}

Image<float> textured_map(View<const float> map, Size size, std::uint64_t seed) {
  Image<float> ln = resize(map, {std::max(2, size.width / 4), std::max(2, size.height / 4)});
  std::vector<float> greens;
  for (int y = 0; y < ln.height(); ++y) {
    for (float* v = ln.row(y); v != ln.row(y) + ln.row_samples(); ++v) *v = std::log(std::max(*v, 1e-6f));
    for (int x = 0; x < ln.width(); ++x) greens.push_back(ln(x, y, 1));
  }
  const auto middle = greens.begin() + static_cast<std::ptrdiff_t>(greens.size() / 2);
  std::nth_element(greens.begin(), middle, greens.end());
  const float median = *middle;
  Image<float> scene(size, 3);
  for_rows(size.height, 16, [&](int first, int last) {
    std::vector<float> texture(static_cast<std::size_t>(size.width));
    for (int y = first; y < last; ++y) {
      texture_row(texture, y, seed);
      const float v = static_cast<float>(y) * static_cast<float>(ln.height() - 1) / static_cast<float>(size.height);
      for (int x = 0; x < size.width; ++x) {
        const float u = static_cast<float>(x) * static_cast<float>(ln.width() - 1) / static_cast<float>(size.width);
        const int left = static_cast<int>(u), top = static_cast<int>(v);
        const float s = u - static_cast<float>(left), t = v - static_cast<float>(top);
        for (int c = 0; c < 3; ++c) {
          const float above = smoothly(ln(left, top, c), ln(left + 1, top, c), s);
          const float below = smoothly(ln(left, top + 1, c), ln(left + 1, top + 1, c), s);
          scene(x, y, c) = std::exp(smoothly(above, below, t) - median + texture[static_cast<std::size_t>(x)]);
        }
      }
    }
  });
  return scene;
}

std::vector<double> uniform_evs(int count, double step) {
  std::vector<double> evs;
  for (int k = 0; k < count; ++k) evs.push_back(step * (k - (count - 1) / 2));
  return evs;
}

Truth photograph(const BracketPlan& plan, const Path& folder) {
  Truth truth;
  truth.radiance = plan.map.empty() ? textured_scene(plan.size, plan.seed)
                                    : textured_map(read_map(plan.map).map.rgb, plan.size, plan.seed);
  truth.response = plan.response;
  truth.k = kMiddleLevel / kMiddleSeconds;
  std::filesystem::create_directories(folder);
  for (std::size_t shot = 0; shot < plan.evs.size(); ++shot) {
    Exposure exposure;
    exposure.seconds = kMiddleSeconds * std::exp2(plan.evs[shot]);
    const Sensor sensor{plan.response, NoiseModel{}, truth.k};
    const std::uint64_t seed = 1000 * plan.seed + shot;
    const bool still = plan.scene_from_photo.empty();
    const Photo photo = still ? expose(truth.radiance, exposure, sensor, seed)
                              : expose(shake(truth.radiance, plan.scene_from_photo[shot]), exposure, sensor, seed);
    write_photo(folder / fmt::format("shot_{:02d}.{}", shot, plan.format), photo);
    truth.seconds.push_back(*exposure.seconds);
  }
  return truth;
}

}  // namespace hdr::bench
