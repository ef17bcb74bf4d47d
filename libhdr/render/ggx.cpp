#include "libhdr/render/internal/ggx.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

constexpr float kPif = std::numbers::pi_v<float>;

// Nodes of the table: cosine = (i / last)^2, as the albedo bends where the view grazes; roughness in equal steps.
constexpr int kCosines = 32, kRoughnesses = 32;
using Table = std::array<std::array<GgxAlbedo, kCosines>, kRoughnesses>;

// Of a view, the mean of G2 / G1 over the visible normals, whose weight it is: midpoints of cells of the sampler's
// square, close together where the first number is near 1: there are the rare normals of GGX's long tail.
GgxAlbedo integrated(float cosine, float roughness) {
  constexpr int kAcross = 32, kAround = 16;
  const float alpha = ggx_alpha(roughness), c = std::max(cosine, 1e-4f);
  const Vec3f wo(std::sqrt(1 - c * c), 0, c);
  const float seen = 1 + ggx_lambda(wo, alpha);
  double scale = 0, bias = 0, cells = 0;
  for (int y = 0; y < kAround; ++y) {
    for (int x = 0; x < kAcross; ++x) {
      const double t = (x + 0.5) / kAcross, cell = t * t * t;  // d(t^4) / 4
      cells += cell;
      const Vec3f h = ggx_visible_normal(wo, alpha, {1 - cell * t, (y + 0.5) / kAround});
      const Vec3f wi = 2 * wo.dot(h) * h - wo;
      if (wi.z() <= 0) continue;
      const double weight = cell * static_cast<double>(seen / (seen + ggx_lambda(wi, alpha)));
      const float m = std::clamp(1 - wo.dot(h), 0.0f, 1.0f), schlick = m * m * m * m * m;
      scale += weight * static_cast<double>(1 - schlick);
      bias += weight * static_cast<double>(schlick);
    }
  }
  return {static_cast<float>(scale / cells), static_cast<float>(bias / cells)};
}

Table make_table() {
  Table table;
  for (int r = 0; r < kRoughnesses; ++r) {
    for (int c = 0; c < kCosines; ++c) {
      const float root = static_cast<float>(c) / (kCosines - 1);
      table[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] =
          integrated(root * root, static_cast<float>(r) / (kRoughnesses - 1));
    }
  }
  return table;
}

}  // namespace

float ggx_alpha(float roughness) {
  return std::max(roughness * roughness, 1e-3f);
}

float ggx_distribution(const Vec3f& h, float alpha) {
  const float alpha2 = alpha * alpha;
  const float t = (h.x() * h.x() + h.y() * h.y()) / alpha2 + h.z() * h.z();
  return 1 / (kPif * alpha2 * t * t);
}

float ggx_lambda(const Vec3f& w, float alpha) {
  const float tan2 = (w.x() * w.x() + w.y() * w.y()) / (w.z() * w.z());
  return 0.5f * (std::sqrt(1 + alpha * alpha * tan2) - 1);
}

// [Heitz18] section 4: stretch the view to the hemisphere configuration, sample the projected disc, unstretch.
Vec3f ggx_visible_normal(const Vec3f& wo, float alpha, const Vec2& u) {
  const Vec3f view = Vec3f(alpha * wo.x(), alpha * wo.y(), wo.z()).normalized();
  const float length2 = view.x() * view.x() + view.y() * view.y();
  const Vec3f t1 = length2 > 0 ? Vec3f(Vec3f(-view.y(), view.x(), 0) / std::sqrt(length2)) : Vec3f(1, 0, 0);
  const Vec3f t2 = view.cross(t1);
  const auto r = static_cast<float>(std::sqrt(u.x()));
  const auto phi = static_cast<float>(2 * kPi * u.y());
  const float p1 = r * std::cos(phi);
  const float s = 0.5f * (1 + view.z());
  const float p2 = (1 - s) * std::sqrt(std::max(0.0f, 1 - p1 * p1)) + s * r * std::sin(phi);
  const Vec3f n = p1 * t1 + p2 * t2 + std::sqrt(std::max(0.0f, 1 - p1 * p1 - p2 * p2)) * view;
  return Vec3f(alpha * n.x(), alpha * n.y(), std::max(1e-6f, n.z())).normalized();
}

GgxAlbedo ggx_albedo(float cosine, float roughness) {
  static const Table table = make_table();
  const auto place = [](float t, int count) {
    const float at = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(count - 1);
    const int below = std::min(static_cast<int>(at), count - 2);
    return std::pair(static_cast<std::size_t>(below), at - static_cast<float>(below));
  };
  const auto [c, c_share] = place(std::sqrt(std::max(0.0f, cosine)), kCosines);
  const auto [r, r_share] = place(roughness, kRoughnesses);
  const auto mixed = [](const GgxAlbedo& a, const GgxAlbedo& b, float share) {
    return GgxAlbedo{a.scale + share * (b.scale - a.scale), a.bias + share * (b.bias - a.bias)};
  };
  return mixed(mixed(table[r][c], table[r][c + 1], c_share), mixed(table[r + 1][c], table[r + 1][c + 1], c_share),
               r_share);
}

}  // namespace hdr
