#include "libhdr/render/internal/depth_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libhdr/core/sphere.h"

namespace hdr {

DepthMap::DepthMap(const Scene& scene, const Vec3f& towards, const Vec3f& low, const Vec3f& high, int side)
    : towards_(towards), depth_(Size{side, side}, 1) {
  tangents_from_normal(towards, across_, up_);
  float right = std::numeric_limits<float>::lowest(), top = right;
  left_ = bottom_ = std::numeric_limits<float>::max();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f p(corner & 1 ? low.x() : high.x(), corner & 2 ? low.y() : high.y(), corner & 4 ? low.z() : high.z());
    left_ = std::min(left_, p.dot(across_));
    right = std::max(right, p.dot(across_));
    bottom_ = std::min(bottom_, p.dot(up_));
    top = std::max(top, p.dot(up_));
  }
  const float least = 1e-6f * std::max({right - left_, top - bottom_, 1e-20f});
  texel_x_ = std::max(right - left_, least) / static_cast<float>(side);
  texel_y_ = std::max(top - bottom_, least) / static_cast<float>(side);
  margin_ = std::max(texel_x_, texel_y_);
  for (int y = 0; y < side; ++y) std::fill_n(depth_.row(y), side, -std::numeric_limits<float>::infinity());
  std::vector<Vec3f> seen;
  for (const Mesh& mesh : scene.meshes) {
    seen.resize(mesh.positions.size());
    for (std::size_t k = 0; k < seen.size(); ++k) {
      const Vec3f& p = mesh.positions[k];
      seen[k] = {(p.dot(across_) - left_) / texel_x_, (p.dot(up_) - bottom_) / texel_y_, p.dot(towards_)};
    }
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3)
      draw(seen[mesh.indices[k]], seen[mesh.indices[k + 1]], seen[mesh.indices[k + 2]]);
  }
}

// Texels whose middles the triangle covers keep what is nearest to the sky.
void DepthMap::draw(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const auto first = [](float from) { return std::max(0, static_cast<int>(std::ceil(std::max(from, 0.0f) - 0.5f))); };
  const auto last = [](float to, int end) {
    return std::min(end - 1, static_cast<int>(std::floor(std::min(to, static_cast<float>(end)) - 0.5f)));
  };
  const int x0 = first(std::min({a.x(), b.x(), c.x()})), x1 = last(std::max({a.x(), b.x(), c.x()}), depth_.width());
  const int y0 = first(std::min({a.y(), b.y(), c.y()})), y1 = last(std::max({a.y(), b.y(), c.y()}), depth_.height());
  if (x0 > x1 || y0 > y1) return;
  const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  if (area == 0) return;
  // Barycentric coordinates of b and c grow by these along x and y.
  const float bx = (c.y() - a.y()) / area, by = (a.x() - c.x()) / area;
  const float cx = (a.y() - b.y()) / area, cy = (b.x() - a.x()) / area;
  const float db = b.z() - a.z(), dc = c.z() - a.z();
  for (int y = y0; y <= y1; ++y) {
    float* row = depth_.row(y);
    const float dy = static_cast<float>(y) + 0.5f - a.y();
    for (int x = x0; x <= x1; ++x) {
      const float dx = static_cast<float>(x) + 0.5f - a.x();
      const float to_b = bx * dx + by * dy, to_c = cx * dx + cy * dy;
      if (to_b < 0 || to_c < 0 || to_b + to_c > 1) continue;
      row[x] = std::max(row[x], a.z() + to_b * db + to_c * dc);
    }
  }
}

float DepthMap::open(const Vec3f& position, const Vec3f& normal) const {
  const float cosine = normal.dot(towards_);
  if (!(cosine > 1e-3f)) return 0;
  const float x = (position.dot(across_) - left_) / texel_x_ - 0.5f;
  const float y = (position.dot(up_) - bottom_) / texel_y_ - 0.5f;
  const auto side = static_cast<float>(depth_.width());
  if (!(x > -1 && y > -1 && x < side && y < side)) return 1;
  const int left = static_cast<int>(std::floor(x)), bottom = static_cast<int>(std::floor(y));
  // The plane's depth falls by these from texel to texel.
  const float fall_x = normal.dot(across_) / cosine * texel_x_, fall_y = normal.dot(up_) / cosine * texel_y_;
  const float depth = position.dot(towards_) + margin_;
  float open = 0;
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      const int column = std::clamp(left + i, 0, depth_.width() - 1),
                row = std::clamp(bottom + j, 0, depth_.height() - 1);
      const float off_x = static_cast<float>(left + i) - x, off_y = static_cast<float>(bottom + j) - y;
      const float share = (1 - std::abs(off_x)) * (1 - std::abs(off_y));
      if (depth_(column, row) <= depth - fall_x * off_x - fall_y * off_y) open += share;
    }
  }
  return open;
}

}  // namespace hdr
