// What kAuto becomes: by what the scene can do to the light, and by how the probe's light is spread.
#include <fmt/format.h>

#include <algorithm>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/sh.h"
#include "libhdr/render/internal/integrator.h"

namespace hdr {
namespace {

// Light, and what part of it comes from pixels ten times brighter than the mean: suns and lamps.
struct Suns {
  double light = 0, solid_angle = 0;  ///< shares
};

Suns suns_of(const Environment& light) {
  const View<const float> map = light.latlong();
  const Rgb power = light.total_power();
  const double total = luminance(power[0], power[1], power[2]), bright = 10 * total / (4 * kPi);
  if (!(total > 0)) return {};
  return reduce_rows(
      map.height(), 16, Suns{},
      [&](int first, int last) {
        Suns part;
        for (int y = first; y < last; ++y) {
          const double solid_angle = latlong_pixel_solid_angle(y, map.width(), map.height());
          for (int x = 0; x < map.width(); ++x) {
            const float* p = map.pixel(x, y);
            const double value = luminance<double>(p[0], p[1], p[2]);
            if (value <= bright) continue;
            part.light += value * solid_angle / total;
            part.solid_angle += solid_angle / (4 * kPi);
          }
        }
        return part;
      },
      [](Suns& sum, const Suns& part) {
        sum.light += part.light;
        sum.solid_angle += part.solid_angle;
      });
}

bool has_shadow_catcher(const Scene& scene) {
  return std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [](const Mesh& mesh) { return mesh.material.shadow_catcher; });
}

bool all_diffuse(const Scene& scene) {
  return std::all_of(scene.meshes.begin(), scene.meshes.end(),
                     [](const Mesh& mesh) { return mesh.material.kind == MaterialKind::kDiffuse; });
}

}  // namespace

MethodChoice choose_method(const Setting& setting) {
  if (setting.options.method != RenderMethod::kAuto) return {setting.options.method};
  // Of ground with and without objects the difference is wanted: both by one method, with the same random numbers.
  if (has_shadow_catcher(setting.scene)) return {RenderMethod::kMis, 2, "differences of pictures want one method"};
  constexpr double kWithoutAsking = 0.01;
  const double error = setting.options.error > 0 ? setting.options.error : kWithoutAsking;
  if (setting.convex && all_diffuse(setting.scene)) {
    const View<const float> map = setting.light.latlong();
    const ChosenSh chosen = project_within(map, LatLong{map.size()}, error);
    if (chosen.met) {
      return {RenderMethod::kSh, chosen.sh.degree,
              fmt::format(
                  "nothing can occlude, and the probe's irradiance is that of harmonics of degree {} within {:.2g} %",
                  chosen.sh.degree, 100 * chosen.bound),
              fmt::format(
                  "directions and shadow rays: irradiance from harmonics of degree {}; error at most {:.2g} % of the "
                  "largest irradiance",
                  chosen.sh.degree, 100 * chosen.bound)};
    }
  }
  const Suns suns = suns_of(setting.light);
  constexpr double kWorthASun = 0.1;
  if (suns.light > kWorthASun) {
    return {RenderMethod::kMis, 2,
            fmt::format(
                "{:.0f} % of the probe's light comes from {:.2g} % of the sphere: directions from the probe and from "
                "the surfaces",
                100 * suns.light, 100 * suns.solid_angle)};
  }
  return {RenderMethod::kMis, 2, "the probe is soft, but the scene shades itself: directions from both"};
}

}  // namespace hdr
