#include "libhdr/render/internal/interreflection.h"

#include <algorithm>
#include <numeric>

#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/points.h"
#include "libhdr/render/internal/rows.h"

namespace hdr {

Interreflection::Interreflection(const Setting& setting) : setting_(setting) {
  HDR_ASSERT(setting.options.bounces > 0);
  // At each surface on the way one direction of the probe and one of its own, weighted [Veach95].
  own_.directions = 2 * kRows;
  own_.camera_rays = kRows;
  own_.rows_by_chance = true;
}

void Interreflection::begin(const Pass& pass) {
  const auto index = static_cast<std::uint64_t>(pass.index);
  for (std::size_t k = 0; k < kSets; ++k) {
    sets_[k].clear();
    for (int depth = 0; depth < setting_.options.bounces; ++depth) {
      const std::uint64_t stream = address(pass.seed, index, k, 128 + static_cast<unsigned>(depth));
      Pass own = own_;
      own.seed = hash64(stream);
      sets_[k].push_back({sobol_hemisphere(kRows, stream, depth == 0 ? RowOrder::kParts : RowOrder::kByChance),
                          make_mis(setting_, 0.5)});
      sets_[k].back().direct->begin(own);
    }
  }
}

// Row r goes from the camera ray starts[r] of `from` and is camera ray r of `to`.
void Interreflection::meet(const Surfaces& from, const Starts& starts, int rows, const DirectionPool& pool,
                           std::uint32_t tile, Surfaces& to, std::int64_t& rays) const {
  to.resize(from.places, kRows);
  to.tile = tile;
  Rays towards(from.places);
  std::array<std::vector<float>, 6> arrays;
  std::vector<int> places;
  for (int row = 0; row < rows; ++row) {
    const int start = starts[static_cast<std::size_t>(row)];
    towards.turn(pool, pool.begin(row, tile), from, start);
    for (int k = 0; k < from.places; ++k) {
      const auto at = static_cast<std::size_t>(k), origin = static_cast<std::size_t>(start * from.places + k);
      if (!towards.wanted[at]) continue;
      const float values[] = {from.x[origin], from.y[origin], from.z[origin],
                              towards.x[at],  towards.y[at],  towards.z[at]};
      for (std::size_t i = 0; i < 6; ++i) arrays[i].push_back(values[i]);
      places.push_back(row * from.places + k);
    }
  }
  std::vector<std::optional<Hit>> hits(places.size());
  setting_.tracer.intersect(
      {arrays[0].data(), arrays[1].data(), arrays[2].data(), arrays[3].data(), arrays[4].data(), arrays[5].data()},
      hits, Spread::kWide);
  rays += static_cast<std::int64_t>(hits.size());
  for (std::size_t k = 0; k < hits.size(); ++k)
    if (hits[k]) to.set(places[k], *hits[k], -Vec3f(arrays[3][k], arrays[4][k], arrays[5][k]), true);
}

// Adds what surfaces receive, from the probe and by way of those that may still follow.
void Interreflection::light(const Surfaces& at, const Set& set, std::size_t depth, Light& out,
                            std::int64_t& rays) const {
  set[depth].direct->irradiance(at, own_, out, rays);
  if (depth + 1 == set.size()) return;
  Starts starts;
  std::iota(starts.begin(), starts.end(), 0);
  Surfaces next;
  meet(at, starts, kRows, set[depth + 1].onward, at.tile, next, rays);
  Light there;
  there.reset(next.count());
  light(next, set, depth + 1, there, rays);
  for (int k = 0; k < next.count(); ++k)
    if (const auto& hit = next.hits[static_cast<std::size_t>(k)])
      out.add(k, diffuse_albedo(setting_.scene, *hit) * there.of(k));
}

// Directions are cosine-weighted: E = pi / N sum of L, and L = albedo E / pi of what is met.
void Interreflection::irradiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t& rays) const {
  const int rows = std::max(pass.camera_rays, pass.directions / 2);
  const float share = static_cast<float>(pass.camera_rays) / static_cast<float>(rows);
  for (int first = 0; first < rows; first += kRows) {
    const auto chunk = static_cast<std::uint32_t>(first / kRows);
    const Set& set = sets_[chunk % kSets];
    Starts starts{};
    const int here = std::min(kRows, rows - first);
    for (int row = 0; row < here; ++row) starts[static_cast<std::size_t>(row)] = pass.camera_ray_of(first + row);
    Surfaces met;
    meet(at, starts, here, set[0].onward, at.tile + chunk / kSets, met, rays);
    Light there;
    there.reset(met.count());
    light(met, set, 0, there, rays);
    for (int row = 0; row < here; ++row) {
      for (int k = 0; k < at.places; ++k) {
        const int place = row * at.places + k;
        if (const auto& hit = met.hits[static_cast<std::size_t>(place)])
          out.add(starts[static_cast<std::size_t>(row)] * at.places + k,
                  share * diffuse_albedo(setting_.scene, *hit) * there.of(place));
      }
    }
  }
}

void Interreflection::leaving(const std::vector<std::optional<Hit>>& hits, const std::vector<Vec3f>& towards,
                              std::uint64_t stream, std::vector<Rgbf>& rgb, std::int64_t& rays) const {
  constexpr int kPlaces = DirectionPool::kVariants;
  constexpr std::size_t kTogether = kPlaces * kRows;
  for (std::size_t first = 0; first < hits.size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, hits.size() - first);
    const std::uint64_t own = hash64(stream + first);
    Surfaces met;
    met.resize(kPlaces, kRows);
    met.tile = static_cast<std::uint32_t>(own >> 32);
    for (std::size_t k = 0; k < count; ++k)
      if (hits[first + k]) met.set(static_cast<int>(k), *hits[first + k], towards[first + k], true);
    Light there;
    there.reset(met.count());
    light(met, sets_[own % kSets], 0, there, rays);
    for (std::size_t k = 0; k < count; ++k) {
      const auto& hit = hits[first + k];
      rgb[first + k] =
          hit ? Rgbf(diffuse_albedo(setting_.scene, *hit) * there.of(static_cast<int>(k)) / static_cast<float>(kPi))
              : Rgbf(Rgbf::Zero());
    }
  }
}

}  // namespace hdr
