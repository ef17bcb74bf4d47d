#include "libhdr/render/internal/direction_pool.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/light_strata.h"
#include "libhdr/render/internal/points.h"

namespace hdr {
namespace {

// More sets make tiles less alike; many rows do that by themselves.
int sets_for(int rows) {
  return std::clamp(512 / std::max(rows, 1), 1, 8);
}

// Which place takes which variant: by chance, or neighbours would have the same halves of all strata in every pass.
std::vector<int> shuffled(int count, std::uint64_t stream) {
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  Random random(stream, 1);
  for (std::size_t k = order.size(); k > 1; --k)
    std::swap(order[k - 1], order[(std::uint64_t{random.bits()} * k) >> 32]);
  return order;
}

void put_cosine_weighted(DirectionPool& pool, std::size_t k, const Vec2& u) {
  const auto r = static_cast<float>(std::sqrt(u.x()));
  const auto phi = static_cast<float>(2 * kPi * u.y());
  pool.x[k] = r * std::cos(phi);
  pool.y[k] = r * std::sin(phi);
  pool.z[k] = static_cast<float>(std::sqrt(1 - u.x()));
  pool.u[k] = static_cast<float>(u.x());
  pool.v[k] = static_cast<float>(u.y());
}

void put(DirectionPool& pool, std::size_t k, const Vec3f& dir, const Rgbf& light, float pdf) {
  pool.x[k] = dir.x();
  pool.y[k] = dir.y();
  pool.z[k] = dir.z();
  pool.red[k] = light[0];
  pool.green[k] = light[1];
  pool.blue[k] = light[2];
  pool.pdf[k] = pdf;
}

// Sobol points, `rows` for each variant, consecutive: variants together are as well spread as each is. Each variant's
// points are put in the order of the unit square's strips, so that a row's points lie near each other.
std::vector<Vec2> sliced_sobol(int rows, int variants, std::uint64_t stream, RowOrder row_order) {
  std::vector<Vec2> points(static_cast<std::size_t>(rows) * static_cast<std::size_t>(variants));
  const double strips = std::max(1.0, std::floor(std::sqrt(static_cast<double>(rows))));
  const std::vector<int> order = shuffled(variants, stream);
  for_rows(variants, 8, [&](int first, int last) {
    std::vector<Vec2> own(static_cast<std::size_t>(rows));
    for (int variant = first; variant < last; ++variant) {
      for (int k = 0; k < rows; ++k)
        own[static_cast<std::size_t>(k)] = sobol_point(static_cast<std::uint32_t>(variant * rows + k), stream);
      if (row_order == RowOrder::kByChance) {
        const std::vector<int> rank = shuffled(rows, hash64(stream ^ static_cast<std::uint64_t>(variant)));
        std::vector<Vec2> mixed;
        for (const int k : rank) mixed.push_back(own[static_cast<std::size_t>(k)]);
        own = mixed;
      } else {
        std::sort(own.begin(), own.end(), [strips](const Vec2& a, const Vec2& b) {
          const double strip_a = std::floor(a.y() * strips), strip_b = std::floor(b.y() * strips);
          return strip_a != strip_b ? strip_a < strip_b : a.x() < b.x();
        });
      }
      for (int k = 0; k < rows; ++k)
        points[static_cast<std::size_t>(k * variants + order[static_cast<std::size_t>(variant)])] =
            own[static_cast<std::size_t>(k)];
    }
  });
  return points;
}

}  // namespace

DirectionPool::DirectionPool(int rows_wanted, bool of_world) : rows(rows_wanted), sets(sets_for(rows_wanted)) {
  const auto size = static_cast<std::size_t>(rows) * static_cast<std::size_t>(sets) * kVariants;
  for (auto* array : {&x, &y, &z}) array->resize(size);
  if (of_world)
    for (auto* array : {&red, &green, &blue, &pdf}) array->resize(size);
  else
    for (auto* array : {&u, &v}) array->resize(size);
}

void DirectionPool::find_beams() {
  constexpr float kWidest = 0.02f;  // radians; from there on rays are faster as if they had nothing in common
  const float narrow = std::cos(kWidest);
  beams_.assign(x.size() / kVariants, 0);
  for (std::size_t block = 0; block < beams_.size(); ++block) {
    const std::size_t begin = block * kVariants, end = begin + kVariants;
    Vec3f axis = Vec3f::Zero();
    for (std::size_t k = begin; k < end; ++k) axis += Vec3f(x[k], y[k], z[k]);
    axis.normalize();
    float farthest = 1;
    for (std::size_t k = begin; k < end; ++k) farthest = std::min(farthest, axis.dot(Vec3f(x[k], y[k], z[k])));
    beams_[block] = farthest > narrow;
  }
}

DirectionPool stratified_hemisphere(int rows, std::uint64_t stream) {
  DirectionPool pool(rows, false);
  const int variants = pool.sets * DirectionPool::kVariants;
  // The largest divisor that is not above the square root: M x N strata.
  int m = static_cast<int>(std::sqrt(static_cast<double>(std::max(rows, 1))));
  while (rows % m != 0) --m;
  const int n = rows / m;
  for_rows(rows, 8, [&](int first, int last) {
    for (int k = first; k < last; ++k) {
      const std::uint64_t own = hash64(stream ^ hash64(static_cast<std::uint64_t>(k)));
      const std::vector<int> order = shuffled(variants, own);
      for (int variant = 0; variant < variants; ++variant) {
        const Vec2 xi = sobol_point(static_cast<std::uint32_t>(variant), own);
        put_cosine_weighted(pool, pool.begin(k, 0) + static_cast<std::size_t>(order[static_cast<std::size_t>(variant)]),
                            {(k / n + xi.x()) / m, (k % n + xi.y()) / n});
      }
    }
  });
  return pool;
}

DirectionPool sobol_hemisphere(int rows, std::uint64_t stream, RowOrder order) {
  DirectionPool pool(rows, false);
  const std::vector<Vec2> points = sliced_sobol(rows, pool.sets * DirectionPool::kVariants, stream, order);
  for (std::size_t k = 0; k < points.size(); ++k) put_cosine_weighted(pool, k, points[k]);
  return pool;
}

DirectionPool sobol_environment(const Environment& light, int rows, std::uint64_t stream, RowOrder order) {
  DirectionPool pool(rows, true);
  const std::vector<Vec2> points = sliced_sobol(rows, pool.sets * DirectionPool::kVariants, stream, order);
  for_rows(static_cast<int>(points.size()), 1024, [&](int first, int last) {
    std::vector<Environment::Sample> samples(static_cast<std::size_t>(last - first));
    light.sample(std::span(points).subspan(static_cast<std::size_t>(first), samples.size()), samples);
    for (std::size_t k = 0; k < samples.size(); ++k)
      put(pool, static_cast<std::size_t>(first) + k, samples[k].dir, samples[k].radiance, samples[k].pdf);
  });
  pool.find_beams();
  return pool;
}

DirectionPool stratified_light(const LightStrata& strata, std::uint64_t stream) {
  DirectionPool pool(strata.count(), true);
  const int variants = pool.sets * DirectionPool::kVariants;
  for_rows(pool.rows, 4, [&](int first, int last) {
    for (int row = first; row < last; ++row) {
      const std::uint64_t own = hash64(stream ^ hash64(static_cast<std::uint64_t>(row)));
      const std::vector<int> order = shuffled(variants, own);
      for (int variant = 0; variant < variants; ++variant) {
        const LightStrata::Sample sample = strata.sample(row, sobol_point(static_cast<std::uint32_t>(variant), own));
        put(pool, pool.begin(row, 0) + static_cast<std::size_t>(order[static_cast<std::size_t>(variant)]), sample.dir,
            sample.light, 0);
      }
    }
  });
  pool.find_beams();
  return pool;
}

}  // namespace hdr
