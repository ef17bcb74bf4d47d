#include "libhdr/render/internal/rows.h"

#include <algorithm>

namespace hdr {

Rays::Rays(int count) : places(count), x(nullptr), y(nullptr), z(nullptr) {
  for (auto* array : {&turned_x_, &turned_y_, &turned_z_, &weight}) array->resize(static_cast<std::size_t>(count));
  wanted.resize(static_cast<std::size_t>(count));
}

// Loops over plain arrays, without a branch, that are told not to overlap: the compiler makes vectors of them.
void Rays::turn(const DirectionPool& pool, std::size_t begin, const Surfaces& at, int camera_ray) {
  const auto first = static_cast<std::size_t>(camera_ray * places);
  const auto turned = [&](const std::vector<float>& tangent, const std::vector<float>& bitangent,
                          const std::vector<float>& normal, std::vector<float>& out) {
    const float *t = tangent.data() + first, *b = bitangent.data() + first, *n = normal.data() + first;
    const float *px = pool.x.data() + begin, *py = pool.y.data() + begin, *pz = pool.z.data() + begin;
    float* __restrict to = out.data();
    for (int k = 0; k < places; ++k) to[k] = px[k] * t[k] + py[k] * b[k] + pz[k] * n[k];
    return out.data();
  };
  x = turned(at.tangent_x, at.bitangent_x, at.normal_x, turned_x_);
  y = turned(at.tangent_y, at.bitangent_y, at.normal_y, turned_y_);
  z = turned(at.tangent_z, at.bitangent_z, at.normal_z, turned_z_);
  std::copy_n(at.diffuse.begin() + static_cast<std::ptrdiff_t>(first), places, wanted.begin());
}

bool Rays::face(const DirectionPool& pool, std::size_t begin, const Surfaces& at, int camera_ray) {
  const auto first = static_cast<std::size_t>(camera_ray * places);
  const float *nx = at.normal_x.data() + first, *ny = at.normal_y.data() + first, *nz = at.normal_z.data() + first;
  const float *px = pool.x.data() + begin, *py = pool.y.data() + begin, *pz = pool.z.data() + begin;
  x = px, y = py, z = pz;
  float* __restrict cosine = weight.data();
  std::int32_t* __restrict lanes = wanted.data();
  std::int32_t any = 0;
  for (int k = 0; k < places; ++k) {
    const float c = std::max(nx[k] * px[k] + ny[k] * py[k] + nz[k] * pz[k], 0.0f);
    cosine[k] = c;
    lanes[k] = c > 0 ? -1 : 0;
    any |= lanes[k];
  }
  return any != 0;
}

void Rays::keep_visible(const Visibility& visibility, const Surfaces& at, int camera_ray, Spread spread,
                        std::int64_t& traced) {
  const auto first = static_cast<std::size_t>(camera_ray * places);
  visibility.keep(at, {at.x.data() + first, at.y.data() + first, at.z.data() + first, x, y, z}, spread, wanted, traced);
}

namespace {

/// Adds weight_of(k), place by place, times a row's light to the camera ray's, wherever the direction is wanted.
template <class WeightOf>
void add_weighted(const Rays& rays, const DirectionPool& pool, std::size_t begin, int camera_ray,
                  const WeightOf& weight_of, Light& out) {
  const auto first = static_cast<std::size_t>(camera_ray * rays.places);
  const float *red = pool.red.data() + begin, *green = pool.green.data() + begin, *blue = pool.blue.data() + begin;
  float* __restrict to_red = out.rgb[0].data() + first;
  float* __restrict to_green = out.rgb[1].data() + first;
  float* __restrict to_blue = out.rgb[2].data() + first;
  const std::int32_t* lanes = rays.wanted.data();
  for (int k = 0; k < rays.places; ++k) {
    const float w = lanes[k] != 0 ? weight_of(k) : 0.0f;
    to_red[k] += w * red[k];
    to_green[k] += w * green[k];
    to_blue[k] += w * blue[k];
  }
}

}  // namespace

void Rays::add(const DirectionPool& pool, std::size_t begin, int camera_ray, float scale, Light& out) const {
  const auto scaled = [scale, by = weight.data()](int k) { return scale * by[k]; };
  add_weighted(*this, pool, begin, camera_ray, scaled, out);
}

void Rays::add_balanced(const DirectionPool& pool, std::size_t begin, int camera_ray, const Densities& densities,
                        Light& out) const {
  const auto balanced = [densities, pdf = pool.pdf.data() + begin, cosine = weight.data()](int k) {
    // What is drawn has a density; a weight without one is of a place that nothing is added to.
    return cosine[k] / std::max(densities.probe * pdf[k] + densities.surface * cosine[k], 1e-30f);
  };
  add_weighted(*this, pool, begin, camera_ray, balanced, out);
}

}  // namespace hdr
