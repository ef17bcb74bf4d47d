#pragma once
// A scene in which one thing moves: another place in every shot, and hand shake if wanted. What each shot shows is
// known, so a map can be asked at each pixel whether it shows one of these.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "libhdr/core/random.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/expose.h"
#include "tests/support/colour_camera.h"
#include "tests/support/scene.h"

namespace hdr::test {

struct MoverPlan {
  Size size{300, 200};
  double scene_stops = 7;
  std::vector<double> evs{-4, -2, 0, 2, 4};
  Response response = srgb_response(8);
  NoiseModel noise{};
  std::optional<ColourCamera> camera;  ///< takes the photographs, its curve and noise in place of those above
  double colour = 0;                   ///< of the scene, stops
  double object = 0.15;                ///< its width as a share of the picture's
  double object_stops = 1.5;           ///< brighter (or, negative, darker) than the scene around it
  double step = 0.1;  ///< from place to place, as a share of the picture's width: below `object` they overlap
  double shift = 0;   ///< hand shake, up to so many pixels each way
  std::uint64_t seed = 1;
};

struct MovingScene {
  Bracket moving, still;               ///< the same noise, with and without the thing
  std::vector<Mat3> ref_from_photo;    ///< the shake; the middle shot has none
  std::vector<Image<float>> truths;    ///< without it, then with it as each shot shows it
  std::vector<Image<float>> coverage;  ///< of the thing in each shot, 0 .. 1, one channel
  double map_per_scene = 1;            ///< radiance in the unit of the map over that of the scene
};

namespace movers {

/// A soft-edged ellipse with stripes of its own: coverage, and radiance over that of the background's mean.
inline double coverage_at(double x, double y, double cx, double cy, double rx, double ry) {
  const double r = std::hypot((x - cx) / rx, (y - cy) / ry);
  return std::clamp((1 - r) * std::min(rx, ry) + 0.5, 0.0, 1.0);
}

/// A lens: 1-2-1 both ways. Without it the shake's own interpolation would blur some shots and others not.
inline Image<float> through_lens(const Image<float>& scene) {
  Image<float> out(scene.size(), 3);
  const auto [width, height] = scene.size();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        float sum = 0;
        for (int k = 0; k < 9; ++k) {
          const int u = std::clamp(x + k % 3 - 1, 0, width - 1), v = std::clamp(y + k / 3 - 1, 0, height - 1);
          sum += scene(u, v, c) * static_cast<float>((k % 3 == 1 ? 2 : 1) * (k / 3 == 1 ? 2 : 1));
        }
        out(x, y, c) = sum / 16;
      }
    }
  }
  return out;
}

inline Photo shot_of(View<const float> view, const MoverPlan& plan, std::size_t k) {
  Exposure exposure;
  exposure.seconds = std::exp2(plan.evs[k]);
  Photo photo = plan.camera ? photograph(view, *exposure.seconds, *plan.camera, 77 * plan.seed + k)
                            : expose(view, exposure, {plan.response, plan.noise, 0.18}, 77 * plan.seed + k);
  photo.path = "shot" + std::to_string(k) + ".png";
  return photo;
}

}  // namespace movers

inline MovingScene moving_scene(const MoverPlan& plan) {
  MovingScene made;
  const auto [width, height] = plan.size;
  Image<float> scene = test_scene(width, height, plan.scene_stops, plan.seed);
  if (plan.colour > 0) scene = coloured(scene, plan.colour, plan.seed);
  const Image<float> background = movers::through_lens(movers::through_lens(scene));
  Random random(plan.seed, 0x30f3);
  const double rx = 0.5 * plan.object * width, ry = rx * (0.8 + 1.2 * random.uniform());
  const double steps = static_cast<double>(plan.evs.size() - 1) * plan.step * width;
  const double x0 = rx + random.uniform() * std::max(1.0, width - 2 * rx - steps);
  const double y0 = ry + random.uniform() * std::max(1.0, height - 2 * ry);
  std::vector<std::size_t> place;  // shots meet the thing in any order
  for (std::size_t k = 0; k < plan.evs.size(); ++k) place.push_back(k);
  for (std::size_t k = place.size(); k > 1; --k) std::swap(place[k - 1], place[random.bits() % k]);
  const double wave = 0.4 + 0.5 * random.uniform();
  made.truths.push_back(background.clone());
  for (std::size_t k = 0; k < plan.evs.size(); ++k) {
    const double cx = x0 + static_cast<double>(place[k]) * plan.step * width;
    const double cy = y0 + 0.1 * ry * random.normal();
    const auto at = [&](double v, int limit) { return std::clamp(static_cast<int>(v), 0, limit - 1); };
    const float around = background(at(cx, width), at(cy, height), 1);
    Image<float> truth = background.clone();
    made.coverage.emplace_back(width, height, 1);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double a = movers::coverage_at(x, y, cx, cy, rx, ry);
        made.coverage.back()(x, y) = static_cast<float>(a);
        if (a == 0) continue;
        const double texture = 0.3 * std::sin(wave * (x - cx)) * std::cos(0.7 * wave * (y - cy));
        for (int c = 0; c < 3; ++c) {
          const double own = around * std::exp2(plan.object_stops + texture + 0.2 * (c - 1));
          truth(x, y, c) = static_cast<float>((1 - a) * truth(x, y, c) + a * own);
        }
      }
    }
    Mat3 scene_from_photo = Mat3::Identity();
    if (k != (plan.evs.size() - 1) / 2) {
      scene_from_photo(0, 2) = plan.shift * (2 * random.uniform() - 1);
      scene_from_photo(1, 2) = plan.shift * (2 * random.uniform() - 1);
    }
    made.ref_from_photo.push_back(scene_from_photo);
    made.moving.shots.push_back(movers::shot_of(shake(truth, scene_from_photo), plan, k));
    made.still.shots.push_back(movers::shot_of(shake(background, scene_from_photo), plan, k));
    made.moving.input_order.push_back(static_cast<int>(k));
    made.still.input_order.push_back(static_cast<int>(k));
    made.truths.push_back(std::move(truth));
  }
  made.map_per_scene = 0.18 * plan.response.exposure(1, std::ldexp(1.0, plan.response.bits) - 1) *
                       std::exp2(plan.evs[(plan.evs.size() - 1) / 2]);
  return made;
}

/// |log2| of the map (green) over the truth that it is closest to, a pixel at a time, where some shot exposes that
/// truth well; negative elsewhere.
inline Image<float> closest_errors(View<const float> map, const MovingScene& scene, const MoverPlan& plan) {
  Image<float> errors(map.size(), 1);
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      double least = 1e9;
      for (const Image<float>& truth : scene.truths) {
        least = std::min(least, std::abs(std::log2(map(x, y, 1) / (truth(x, y, 1) * scene.map_per_scene))));
      }
      const bool well = std::all_of(scene.truths.begin(), scene.truths.end(), [&](const Image<float>& truth) {
        return std::any_of(plan.evs.begin(), plan.evs.end(), [&](double ev) {
          const double level = 0.18 * truth(x, y, 1) * std::exp2(ev);
          return level > 0.02 && level < 0.9;
        });
      });
      errors(x, y) = well ? static_cast<float>(least) : -1.0f;
    }
  }
  return errors;
}

inline double error_quantile(const Image<float>& errors, double q) {
  std::vector<float> all;
  for (int y = 0; y < errors.height(); ++y) {
    for (int x = 0; x < errors.width(); ++x) {
      if (errors(x, y) >= 0) all.push_back(errors(x, y));
    }
  }
  if (all.empty()) return 0;
  std::sort(all.begin(), all.end());
  return all[static_cast<std::size_t>(q * static_cast<double>(all.size() - 1))];
}

}  // namespace hdr::test
