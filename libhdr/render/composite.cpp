#include "libhdr/render/composite.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"

namespace hdr {
namespace {

Scene ground_of(const Scene& scene) {
  Scene ground;
  ground.camera = scene.camera;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.material.shadow_catcher) ground.meshes.push_back(mesh);
  return ground;
}

// Light per covered pixel with objects by that without: 1 where there is no ground, or no light on it.
float ratio(float with, float with_share, float without, float without_share) {
  if (!(with_share > 0 && without_share > 0 && without > 0)) return 1;
  if (with == without && with_share == without_share) return 1;
  const double value = static_cast<double>(with) / with_share / (static_cast<double>(without) / without_share);
  return std::isfinite(value) ? static_cast<float>(value) : 1.0f;
}

}  // namespace

Differential render_differential(const Scene& scene, const Environment& light, const RenderOptions& options) {
  RenderOptions settings = options;
  settings.backdrop = false;
  Differential result;
  result.with = render(scene, light, settings);
  // The same method for both, whatever kAuto would choose without objects: the same random numbers, and no difference
  // where there is none.
  settings.method = result.with.method;
  settings.progress = nullptr;
  Rendering without = render(ground_of(scene), light, settings);
  result.with.rays += without.rays;
  const Size size = options.size;
  result.remains = Image<float>(size, 3);
  for_rows(size.height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const float* lit = result.with.ground.pixel(x, y);
        const float* open = without.ground.pixel(x, y);
        for (int c = 0; c < 3; ++c) {
          result.remains(x, y, c) =
              1 - result.with.picture.alpha(x, y) + lit[3] * (ratio(lit[c], lit[3], open[c], open[3]) - 1);
          result.with.picture.rgb(x, y, c) -= lit[c];
        }
      }
    }
  });
  result.ground_light = std::move(without.ground);
  return result;
}

RadianceMap composited(View<const float> background, const Differential& differential, double gain) {
  HDR_ASSERT(background.size() == differential.remains.size() && background.channels() == 3);
  const Size size = background.size();
  RadianceMap result;
  result.rgb = Image<float>(size, 3);
  for_rows(size.height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int k = 0; k < 3 * size.width; ++k) {
        const double objects = gain * differential.with.picture.rgb.row(y)[k];
        result.rgb.row(y)[k] = static_cast<float>(
            std::max(0.0, objects + static_cast<double>(background.row(y)[k]) * differential.remains.row(y)[k]));
      }
    }
  });
  return result;
}

RadianceMap cut_out(const Differential& differential) {
  RadianceMap result;
  result.rgb = differential.with.picture.rgb.clone();
  const Size size = result.rgb.size();
  result.alpha = Image<float>(size, 1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const float* remains = differential.remains.pixel(x, y);
      result.alpha(x, y) = std::clamp(1 - luminance(remains[0], remains[1], remains[2]), 0.0f, 1.0f);
    }
  }
  return result;
}

Rendering render_on_ground(const Scene& scene, const Environment& light, const RenderOptions& options) {
  if (ground_of(scene).meshes.empty()) return render(scene, light, options);
  Differential differential = render_differential(scene, light, options);
  RadianceMap picture = cut_out(differential);
  if (options.backdrop) {
    Scene nothing;
    nothing.camera = scene.camera;
    RenderOptions settings = options;
    settings.method = RenderMethod::kMis;
    settings.progress = nullptr;
    picture.rgb = composited(render(nothing, light, settings).picture.rgb, differential).rgb;
  }
  Rendering result = std::move(differential.with);
  result.picture = std::move(picture);
  return result;
}

std::optional<Rgbf> ground_albedo(View<const float> background, View<const float> ground_light, const Rgbf& rendered) {
  HDR_ASSERT(background.size() == ground_light.size() && ground_light.channels() == 4);
  std::array<std::vector<float>, 3> albedos;
  for (int y = 0; y < background.height(); ++y) {
    for (int x = 0; x < background.width(); ++x) {
      const float* light = ground_light.pixel(x, y);
      const float* seen = background.pixel(x, y);
      const bool usable = light[3] == 1 && light[0] > 0 && light[1] > 0 && light[2] > 0;
      for (int c = 0; usable && c < 3; ++c)
        albedos[static_cast<std::size_t>(c)].push_back(rendered[c] * seen[c] / light[c]);
    }
  }
  if (albedos[0].empty()) return std::nullopt;
  Rgbf median;
  for (int c = 0; c < 3; ++c) {
    std::vector<float>& values = albedos[static_cast<std::size_t>(c)];
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    median[c] = *middle;
  }
  return median;
}

}  // namespace hdr
