#pragma once
// Brackets whose motion is known exactly: a scene is made four times finer than the photographs and averaged from an
// offset of whole fine pixels, so a shift of quarters of a pixel needs no interpolation.
#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/align/align.h"
#include "libhdr/core/random.h"
#include "libhdr/response/expose.h"
#include "tests/support/support.h"

namespace hdr::test {

inline constexpr int kFine = 4;

/// The view that `fine` gives when the camera's pixel p shows fine pixels kFine p + margin + offset.
inline Image<float> view_of(const Image<float>& fine, Size size, int margin, int offset_x, int offset_y) {
  Image<float> view(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        float sum = 0;
        for (int k = 0; k < kFine * kFine; ++k) {
          sum += fine(kFine * x + margin + offset_x + k % kFine, kFine * y + margin + offset_y + k / kFine, c);
        }
        view(x, y, c) = sum / (kFine * kFine);
      }
    }
  }
  return view;
}

struct SimulatedBracket {
  Bracket bracket;
  std::vector<Vec2> scene_from_photo;  ///< p_scene = p_photo + this
};

struct SimulationOptions {
  Size size{400, 300};
  int shots = 9;
  double stops_apart = 2;
  double scene_stops = 10;
  double largest_shift = 12;  ///< pixels, in each axis
  std::string response = "srgb";
  bool lossy = false;
};

/// Shifts are whole quarters of a pixel, uniform in the square of `largest_shift`.
inline SimulatedBracket simulate(const SimulationOptions& options, std::uint64_t seed) {
  const int margin = kFine * static_cast<int>(std::ceil(options.largest_shift)) + kFine;
  const Image<float> fine = test_scene(options.size.width * kFine + 2 * margin,
                                       options.size.height * kFine + 2 * margin, options.scene_stops, seed);
  Random random(seed, 1);
  Sensor sensor;
  sensor.response = *response_from_name(options.response, 8);
  sensor.sensitivity = 0.18;
  SimulatedBracket made;
  for (int k = 0; k < options.shots; ++k) {
    const auto draw = [&] {
      return static_cast<int>(std::lround((2 * random.uniform() - 1) * options.largest_shift * kFine));
    };
    const int dx = draw(), dy = draw();
    Exposure exposure;
    exposure.seconds = std::exp2(options.stops_apart * (k - (options.shots - 1) / 2));
    const Image<float> view = view_of(fine, options.size, margin, dx, dy);
    Photo photo = expose(view, exposure, sensor, seed * 100 + static_cast<std::uint64_t>(k));
    photo.path = "shot" + std::to_string(k) + ".png";
    photo.lossy = options.lossy;
    made.bracket.shots.push_back(std::move(photo));
    made.bracket.input_order.push_back(k);
    made.scene_from_photo.emplace_back(static_cast<double>(dx) / kFine, static_cast<double>(dy) / kFine);
  }
  return made;
}

/// Distance between the translation found for shot k and the true one.
inline double error_px(const SimulatedBracket& made, const Alignment& found, std::size_t k) {
  const Vec2 truth = made.scene_from_photo[k] - made.scene_from_photo[static_cast<std::size_t>(found.reference)];
  return (Vec2(found.frames[k].ref_from_photo.topRightCorner<2, 1>()) - truth).norm();
}

inline double usable_share(const Photo& photo) {
  const auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
  int usable = 0;
  for (int y = 0; y < photo.height(); ++y) {
    for (int x = 0; x < photo.width(); ++x) {
      const std::uint8_t* p = codes.pixel(x, y);
      usable += std::min({p[0], p[1], p[2]}) >= 5 && std::max({p[0], p[1], p[2]}) <= 250;
    }
  }
  return static_cast<double>(usable) / (photo.width() * photo.height());
}

}  // namespace hdr::test
