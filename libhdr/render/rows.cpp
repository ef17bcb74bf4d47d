#include "libhdr/render/internal/rows.h"

#include <algorithm>

#include "libhdr/render/internal/row_kernels.h"

namespace hdr {
namespace {

ConstPlanes planes(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z,
                   std::size_t first) {
  return {x.data() + first, y.data() + first, z.data() + first};
}

Planes planes(Light& light, std::size_t first) {
  return {light.rgb[0].data() + first, light.rgb[1].data() + first, light.rgb[2].data() + first};
}

}  // namespace

Rays::Rays(int count) : places(count), x(nullptr), y(nullptr), z(nullptr) {
  for (auto* array : {&turned_x_, &turned_y_, &turned_z_, &weight}) array->resize(static_cast<std::size_t>(count));
  wanted.resize(static_cast<std::size_t>(count));
}

void Rays::turn(const DirectionPool& pool, std::size_t begin, const Surfaces& at, int camera_ray) {
  const auto first = static_cast<std::size_t>(camera_ray * places);
  const ConstPlanes row = planes(pool.x, pool.y, pool.z, begin);
  dot_rows(row, planes(at.tangent_x, at.bitangent_x, at.normal_x, first), places, turned_x_.data());
  dot_rows(row, planes(at.tangent_y, at.bitangent_y, at.normal_y, first), places, turned_y_.data());
  dot_rows(row, planes(at.tangent_z, at.bitangent_z, at.normal_z, first), places, turned_z_.data());
  x = turned_x_.data(), y = turned_y_.data(), z = turned_z_.data();
  std::copy_n(at.diffuse.begin() + static_cast<std::ptrdiff_t>(first), places, wanted.begin());
}

bool Rays::face(const DirectionPool& pool, std::size_t begin, const Surfaces& at, int camera_ray) {
  const auto first = static_cast<std::size_t>(camera_ray * places);
  const ConstPlanes row = planes(pool.x, pool.y, pool.z, begin);
  x = row.x, y = row.y, z = row.z;
  return cosine_rows(planes(at.normal_x, at.normal_y, at.normal_z, first), row, places, weight.data(), wanted.data());
}

void Rays::keep_visible(const Visibility& visibility, const Surfaces& at, int camera_ray, Spread spread,
                        std::int64_t& traced) {
  const auto first = static_cast<std::size_t>(camera_ray * places);
  visibility.keep(at, {at.x.data() + first, at.y.data() + first, at.z.data() + first, x, y, z}, spread, wanted, traced);
}

void Rays::add(const DirectionPool& pool, std::size_t begin, int camera_ray, float scale, Light& out) const {
  const auto first = static_cast<std::size_t>(camera_ray * places);
  add_row(wanted.data(), weight.data(), scale, planes(pool.red, pool.green, pool.blue, begin), places,
          planes(out, first));
}

void Rays::add_balanced(const DirectionPool& pool, std::size_t begin, int camera_ray, const Densities& densities,
                        Light& out) const {
  const auto first = static_cast<std::size_t>(camera_ray * places);
  add_row_balanced(wanted.data(), weight.data(), pool.pdf.data() + begin, densities.probe, densities.surface,
                   planes(pool.red, pool.green, pool.blue, begin), places, planes(out, first));
}

}  // namespace hdr
