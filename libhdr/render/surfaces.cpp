#include "libhdr/render/internal/surfaces.h"

#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

void store(const Vec3f& v, std::size_t k, std::vector<float>& x, std::vector<float>& y, std::vector<float>& z) {
  x[k] = v.x();
  y[k] = v.y();
  z[k] = v.z();
}

}  // namespace

void Surfaces::resize(int places_of_one, int rays) {
  HDR_ASSERT(places_of_one % Tracer::kPacket == 0);
  places = places_of_one;
  camera_rays = rays;
  const auto size = static_cast<std::size_t>(count());
  for (auto* array : {&x, &y, &z, &normal_x, &normal_y, &normal_z, &tangent_x, &tangent_y, &tangent_z, &bitangent_x,
                      &bitangent_y, &bitangent_z})
    array->assign(size, 0.0f);
  diffuse.assign(size, 0);
  hits.assign(size, std::nullopt);
  viewers.assign(size, Vec3f::Zero());
  glossy.clear();
  fronts = true;
  any_diffuse = false;
}

void Surfaces::set(int place, const Hit& hit, const Vec3f& viewer, bool plain) {
  const auto k = static_cast<std::size_t>(place);
  hits[k] = hit;
  viewers[k] = viewer;
  fronts = fronts && hit.front;
  store(hit.position, k, x, y, z);
  if (!plain && hit.material->kind != MaterialKind::kDiffuse) {
    glossy.push_back(place);
    return;
  }
  diffuse[k] = -1;
  any_diffuse = true;
  Vec3f t, b;
  tangents_from_normal(hit.normal, t, b);
  store(hit.normal, k, normal_x, normal_y, normal_z);
  store(t, k, tangent_x, tangent_y, tangent_z);
  store(b, k, bitangent_x, bitangent_y, bitangent_z);
}

Rgbf diffuse_albedo(const Scene& scene, const Hit& hit) {
  const auto of = [](const Material& material) {
    return material.kind == MaterialKind::kPhong ? Rgbf(material.color + material.diffuse) : material.color;
  };
  if (!hit.material->color_texture) return of(*hit.material);
  return of(material_at(scene.meshes[hit.mesh], hit.triangle, hit.weights));
}

}  // namespace hdr
