#include "libhdr/render/layers.h"

#include "libhdr/core/parallel.h"
#include "libhdr/render/internal/camera_rays.h"
#include "libhdr/render/internal/film_filter.h"
#include "libhdr/render/internal/points.h"
#include "libhdr/render/tracer.h"

namespace hdr {
namespace {

Rgbf albedo_of(const Scene& scene, const Hit& hit) {
  const Material material = material_at(scene.meshes[hit.mesh], hit.triangle, hit.weights);
  return material.kind == MaterialKind::kPhong ? Rgbf(material.color + material.diffuse) : material.color;
}

}  // namespace

SurfaceLayers surface_layers(const Scene& scene, const RenderOptions& options) {
  constexpr int kRays = 16;
  const Size size = options.size;
  const Tracer tracer(scene);
  const CameraRays camera(scene.camera, size);
  SurfaceLayers layers{Image<float>(size, 3), Image<float>(size, 1)};
  for_rows(size.height, 4, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const std::uint64_t pixel =
            static_cast<std::uint64_t>(y) * static_cast<std::uint64_t>(size.width) + static_cast<std::uint64_t>(x);
        Rgb albedo = Rgb::Zero();
        double depth = 0;
        int hits = 0;
        for (int ray = 0; ray < kRays; ++ray) {
          const Vec2 u = sobol_point(static_cast<std::uint32_t>(ray), address(options.seed, pixel, 0, 0));
          const auto hit =
              tracer.intersect(camera.eye(), camera.dir_from_px(Vec2(x, y) + filtered_place(options.filter, u)));
          if (!hit) continue;
          ++hits;
          albedo += albedo_of(scene, *hit).cast<double>();
          depth += static_cast<double>((hit->position - camera.eye()).norm());
        }
        for (int c = 0; c < 3; ++c) layers.albedo(x, y, c) = static_cast<float>(albedo[c] / kRays);
        layers.depth(x, y) = hits > 0 ? static_cast<float>(depth / hits) : 0.0f;
      }
    }
  });
  return layers;
}

}  // namespace hdr
