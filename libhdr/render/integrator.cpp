#include "libhdr/render/internal/integrator.h"

#include <algorithm>

#include "libhdr/core/sphere.h"
#include "libhdr/light/sh.h"
#include "libhdr/render/internal/points.h"

namespace hdr {
namespace {

constexpr int kMirrorDepth = 4;

Vec3f mirrored(const Vec3f& dir, const Vec3f& normal) {
  return (dir - 2 * dir.dot(normal) * normal).normalized();
}

}  // namespace

Integrator::Integrator(const Scene& scene, const Environment& light, RenderMethod method, int directions)
    : scene_(scene),
      tracer_(scene),
      light_(light),
      method_(method),
      directions_(directions),
      convex_(tracer_.convex()) {
  HDR_ASSERT(method != RenderMethod::kAuto && directions > 0);
  if (method == RenderMethod::kSh) {
    irradiance_ = irradiance_matrices(project(light.latlong(), LatLong{light.latlong().size()}, 2));
  }
}

// The front of a convex scene sees nothing but the probe.
bool Integrator::visible(const Hit& hit, const Vec3f& dir, std::int64_t& rays) const {
  if (convex_ && hit.front) return true;
  ++rays;
  return !tracer_.occluded(hit.position, dir);
}

// L_o = integral of f(wo, wi) L(wi) S(wi) (n.wi) dwi. Each direction is drawn from the probe or from the surface; with
// both (kMis) turn by turn, so that the density of the mixture is half of each and the balance heuristic [Veach95] is
// division by it. Which comes first is drawn, which keeps an odd number of directions unbiased.
Rgb Integrator::sampled(const Hit& hit, const Vec3f& wo, std::uint64_t points, std::int64_t& rays) const {
  const Bsdf bsdf(*hit.material, hit.normal, wo);
  const double share = method_ == RenderMethod::kImportance ? 1 : method_ == RenderMethod::kMc ? 0 : 0.5;
  const auto first = static_cast<int>(points & 1);
  Rgb sum = Rgb::Zero();
  for (int k = 0; k < directions_; ++k) {
    const bool from_probe = share == 1 || (share > 0 && (k + first) % 2 == 0);
    const auto turn = static_cast<std::uint32_t>(share == 0.5 ? k / 2 : k);
    const std::uint64_t stream = hash64(points + (from_probe ? 1 : 2));
    const Vec2 u = method_ == RenderMethod::kMc ? stratified_point(k, directions_, stream) : sobol_point(turn, stream);
    const Environment::Sample light = from_probe ? light_.sample(u) : light_.lookup(bsdf.sample(u));
    if ((light.radiance <= 0).all()) continue;
    const Rgbf scattered = bsdf.value_times_cosine(light.dir);
    if ((scattered <= 0).all()) continue;
    const double pdf = share * light.pdf + (1 - share) * bsdf.pdf(light.dir);
    if (!(pdf > 0) || !visible(hit, light.dir, rays)) continue;
    sum += scattered.cast<double>() * light.radiance.cast<double>() / pdf;
  }
  return sum / directions_;
}

void Integrator::relight(const std::vector<Transfer>& transfer) {
  HDR_ASSERT(method_ == RenderMethod::kPrt && transfer.size() == scene_.meshes.size());
  const View<const float> latlong = light_.latlong();
  for (std::size_t m = 0; m < transfer.size(); ++m) {
    HDR_ASSERT(transfer[m].vectors.rows() == static_cast<Eigen::Index>(scene_.meshes[m].positions.size()));
    vertices_.push_back(relit(transfer[m], project(latlong, LatLong{latlong.size()}, transfer[m].degree)));
  }
}

Rgb Integrator::smooth_irradiance(const Hit& hit) const {
  Rgb irradiance = Rgb::Zero();
  if (method_ == RenderMethod::kPrt) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = scene_.meshes[hit.mesh].indices[3 * std::size_t{hit.triangle} + k];
      irradiance += hit.weights[k] * vertices_[hit.mesh].row(vertex).transpose().array().cast<double>();
    }
  } else {
    const Eigen::Vector4d n(hit.normal.x(), hit.normal.y(), hit.normal.z(), 1);
    for (std::size_t c = 0; c < 3; ++c) irradiance[static_cast<int>(c)] = n.dot(irradiance_[c] * n);
  }
  // Few coefficients of a sun ring below zero on the far side.
  return irradiance.max(0.0);
}

Rgb Integrator::lit(const Hit& hit, const Vec3f& wo, std::uint64_t points, std::int64_t& rays) const {
  const bool smooth = method_ == RenderMethod::kSh || method_ == RenderMethod::kPrt;
  if (!smooth || hit.material->kind != MaterialKind::kDiffuse) return sampled(hit, wo, points, rays);
  return hit.material->color.cast<double>() / kPi * smooth_irradiance(hit);
}

Integrator::Seen Integrator::seen(const Vec3f& origin, const Vec3f& dir, std::uint64_t points,
                                  std::int64_t& rays) const {
  Vec3f from = origin, towards = dir;
  Rgb reflected = Rgb::Ones();
  Seen result;
  for (int depth = 0; depth <= kMirrorDepth; ++depth) {
    ++rays;
    const std::optional<Hit> hit = tracer_.intersect(from, towards);
    if (!hit) {
      result.radiance = reflected * light_.smooth_radiance(towards).cast<double>();
      return result;
    }
    result.hit = true;
    if (hit->material->kind != MaterialKind::kMirror) {
      result.radiance = reflected * lit(*hit, -towards, points, rays);
      return result;
    }
    reflected *= hit->material->color.cast<double>();
    from = hit->position;
    towards = mirrored(towards, hit->normal);
  }
  return result;  // what a fifth mirror would add is left black
}

}  // namespace hdr
