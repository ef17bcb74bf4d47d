#pragma once
// A camera as they are: its sensor sees colours through filters that overlap, each channel clips at its own full well,
// a matrix makes picture colours of what is left, colours that leave the gamut are crushed, highlights fade to white,
// and then comes the tone curve. No curve by channel explains such a picture where it is bright or colourful.
#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/random.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/expose.h"

namespace hdr::test {

struct ColourCamera {
  Mat3 picture_from_sensor = Mat3::Identity();  ///< rows add up to 1: grey stays grey
  Mat3 sensor_from_scene = Mat3::Identity();    ///< the inverse, but for how vivid the picture is made
  double fades_from = 1;                        ///< largest channel, as a share of white, from which colours fade
  double fade = 0;                              ///< of their colour, at white
  Response curve = srgb_response(8);
  NoiseModel noise{};
  double sensitivity = 0.18;  ///< share of full well that white of radiance 1 fills in a relative exposure H = 1

  ColourCamera() = default;
  /// `off_diagonal` as cameras' profiles have them, with their signs: red from green, red from blue, green from red,
  /// ...
  ColourCamera(const std::array<double, 6>& off_diagonal, double vivid, double from, double share)
      : fades_from(from), fade(share) {
    const auto& m = off_diagonal;
    picture_from_sensor << 1 - m[0] - m[1], m[0], m[1], m[2], 1 - m[2] - m[3], m[3], m[4], m[5], 1 - m[4] - m[5];
    sensor_from_scene = picture_from_sensor.inverse();
    const Vec3 grey(luminance(1.0, 0.0, 0.0), luminance(0.0, 1.0, 0.0), luminance(0.0, 0.0, 1.0));
    const Mat3 saturate = (1 + vivid) * Mat3::Identity() - vivid * Vec3::Ones() * grey.transpose();
    picture_from_sensor = (saturate * picture_from_sensor).eval();
  }

  /// Levels of the picture, 0 .. 1, of what the wells hold.
  Vec3 developed(const Vec3& wells) const {
    Vec3 rgb = (picture_from_sensor * wells).cwiseMax(0).cwiseMin(1);
    const double most = rgb.maxCoeff(), t = std::clamp((most - fades_from) / std::max(1e-9, 1 - fades_from), 0.0, 1.0);
    const double share = fade * t * t * (3 - 2 * t);
    const double white = share > 0 ? most : 0;
    return (1 - share) * rgb + share * white * Vec3::Ones();
  }
};

/// The photograph; noise is a function of (seed, pixel).
inline Photo photograph(View<const float> scene, double seconds, const ColourCamera& camera, std::uint64_t seed) {
  Image<float> levels(scene.size(), 3);
  for (int y = 0; y < scene.height(); ++y) {
    for (int x = 0; x < scene.width(); ++x) {
      Random random(seed, static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(scene.width()) +
                              static_cast<std::uint64_t>(x));
      const Vec3 light(scene(x, y, 0), scene(x, y, 1), scene(x, y, 2));
      Vec3 wells = (camera.sensitivity * seconds * camera.sensor_from_scene * light).cwiseMax(0).cwiseMin(1e6);
      for (double& well : wells) well = std::clamp(well + camera.noise.stddev(well) * random.normal(), 0.0, 1.0);
      const Vec3 rgb = camera.developed(wells);
      for (int c = 0; c < 3; ++c) levels(x, y, c) = static_cast<float>(rgb[c]);
    }
  }
  Exposure once;
  once.seconds = 1;
  constexpr NoiseModel kNone{1e18, 0};
  Photo photo = expose(levels, once, {camera.curve, kNone, 1}, seed);
  photo.exposure.seconds = seconds;
  return photo;
}

/// The scene with colours: of each patch its own, `stops` from grey in some channel, and slowly changing ones.
inline Image<float> coloured(View<const float> scene, double stops, std::uint64_t seed) {
  Random random(seed, 0xc010);
  struct Patch {
    double x, y, radius, hue[3];
  };
  std::vector<Patch> patches;
  for (int k = 0; k < 24; ++k) {
    Patch patch{random.uniform(), random.uniform(), 0.04 + 0.12 * random.uniform(), {}};
    for (double& hue : patch.hue) hue = stops * (2 * random.uniform() - 1);
    patches.push_back(patch);
  }
  double waves[3][3];
  for (auto& wave : waves) {
    for (double& part : wave) part = 3 * random.normal();
  }
  Image<float> out(scene.size(), 3);
  for (int y = 0; y < scene.height(); ++y) {
    for (int x = 0; x < scene.width(); ++x) {
      const double u = (x + 0.5) / scene.width(), v = (y + 0.5) / scene.width();
      double hue[3];
      for (int c = 0; c < 3; ++c) hue[c] = 0.4 * stops * std::sin(waves[c][0] * u + waves[c][1] * v + waves[c][2]);
      for (const Patch& patch : patches) {
        if (std::hypot(u - patch.x, v - patch.y) < patch.radius) std::copy_n(patch.hue, 3, hue);
      }
      for (int c = 0; c < 3; ++c) out(x, y, c) = scene(x, y, c) * static_cast<float>(std::exp2(hue[c]));
    }
  }
  return out;
}

}  // namespace hdr::test
