// Cube maps: which face lies where in the picture, and how it is turned there.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "libhdr/probe/projection.h"

namespace hdr {
namespace {

using Face = Cube::Face;

double along(const Vec3& dir, int axis) {
  return axis > 0 ? dir[axis - 1] : -dir[-axis - 1];
}

void add_axis(Vec3& dir, int axis, double amount) {
  dir[std::abs(axis) - 1] += axis > 0 ? amount : -amount;
}

/// +X -X +Y -Y +Z -Z: right, down, front. OpenEXR's are those of CubeMap::pixelPosition in ImfEnvmap.cpp; OpenGL's are
/// sc, tc and the major axis of its specification's table of cube map faces.
constexpr std::array<std::array<int, 3>, 6> kOpenExr = {
    {{3, -2, 1}, {-3, -2, -1}, {1, -3, 2}, {1, 3, -2}, {-1, -2, 3}, {1, -2, -3}}};
constexpr std::array<std::array<int, 3>, 6> kOpenGl = {
    {{-3, -2, 1}, {3, -2, -1}, {1, 3, 2}, {1, -3, -2}, {1, -2, 3}, {-1, -2, -3}}};

/// three.js looks a face up along (-x, y, z).
int mirrored(int axis) {
  return std::abs(axis) == 1 ? -axis : axis;
}

std::array<Face, 6> strip_faces(Convention convention, bool vertical) {
  std::array<Face, 6> faces{};
  for (int k = 0; k < 6; ++k) {
    auto axes = convention == Convention::kOpenExr ? kOpenExr[static_cast<std::size_t>(k)]
                                                   : kOpenGl[static_cast<std::size_t>(k)];
    if (convention == Convention::kThreeJs) std::transform(axes.begin(), axes.end(), axes.begin(), mirrored);
    faces[static_cast<std::size_t>(k)] = {vertical ? 0 : k, vertical ? k : 0, axes[0], axes[1], axes[2]};
  }
  return faces;
}

/// Unfolded around a front face whose picture has right r, down d and middle f: a neighbour keeps the edge it shares.
std::array<Face, 6> cross_faces(Convention convention, bool vertical) {
  const int r = convention == Convention::kOpenGl ? 1 : -1, d = -2, f = 3;
  const Face back = vertical ? Face{1, 3, r, -d, -f} : Face{3, 1, -r, d, -f};
  return {{{1, 1, r, d, f}, {0, 1, f, d, -r}, {2, 1, -f, d, r}, {1, 0, r, f, -d}, {1, 2, r, -f, d}, back}};
}

}  // namespace

Size Cube::size() const {
  switch (layout) {
    case Layout::kHorizontalCross:
      return {4 * face_px, 3 * face_px};
    case Layout::kVerticalCross:
      return {3 * face_px, 4 * face_px};
    case Layout::kHorizontalStrip:
      return {6 * face_px, face_px};
    default:
      return {face_px, 6 * face_px};
  }
}

std::array<Face, 6> Cube::faces() const {
  switch (layout) {
    case Layout::kHorizontalCross:
      return cross_faces(convention, false);
    case Layout::kVerticalCross:
      return cross_faces(convention, true);
    case Layout::kHorizontalStrip:
      return strip_faces(convention, false);
    default:
      return strip_faces(convention, true);
  }
}

std::optional<Vec3> Cube::dir_from_px(const Vec2& px) const {
  const Size whole = size();
  if (!(px.x() >= 0 && px.x() <= whole.width && px.y() >= 0 && px.y() <= whole.height)) return std::nullopt;
  const int column = std::min(static_cast<int>(px.x() / face_px), whole.width / face_px - 1);
  const int row = std::min(static_cast<int>(px.y() / face_px), whole.height / face_px - 1);
  for (const Face& face : faces()) {
    if (face.column != column || face.row != row) continue;
    Vec3 dir = Vec3::Zero();
    add_axis(dir, face.front, 1);
    add_axis(dir, face.right, 2 * (px.x() / face_px - column) - 1);
    add_axis(dir, face.down, 2 * (px.y() / face_px - row) - 1);
    return dir.normalized();
  }
  return std::nullopt;
}

std::optional<Vec2> Cube::px_from_dir(const Vec3& dir) const {
  const auto all = faces();
  const auto face = *std::max_element(
      all.begin(), all.end(), [&](const Face& a, const Face& b) { return along(dir, a.front) < along(dir, b.front); });
  const double depth = along(dir, face.front);
  const double a = std::clamp(along(dir, face.right) / depth, -1.0, 1.0);
  const double b = std::clamp(along(dir, face.down) / depth, -1.0, 1.0);
  return Vec2((face.column + 0.5 * (a + 1)) * face_px, (face.row + 0.5 * (b + 1)) * face_px);
}

}  // namespace hdr
