#include "libhdr/probe/internal/neighbourhood.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"

namespace hdr::internal {
namespace {

constexpr double kHalfDiagonal = 0.7072;  ///< of a pixel: a centre this far inside the disc has its whole pixel inside

/// dir_from_px with the formula of one region, beyond its edge.
Vec3 extended_dir(const Cube& cube, int region, const Vec2& px) {
  const Cube::Face face = cube.faces()[static_cast<std::size_t>(region)];
  Vec3 dir = Vec3::Zero();
  const auto add = [&dir](int axis, double amount) { dir[std::abs(axis) - 1] += axis > 0 ? amount : -amount; };
  add(face.front, 1);
  add(face.right, 2 * (px.x() / cube.face_px - face.column) - 1);
  add(face.down, 2 * (px.y() / cube.face_px - face.row) - 1);
  return dir.normalized();
}

Vec3 extended_dir(const DualParaboloid& map, int region, const Vec2& px) {
  const double r = 0.25 * map.size.width;
  const double a = (px.x() - (region ? 3 * r : r)) / r, b = (px.y() - r) / r, rho2 = a * a + b * b;
  const double side = region ? -1 : 1;
  return Vec3(-side * 2 * a, -2 * b, side * (1 - rho2)) / (1 + rho2);
}

Vec3 extended_dir(const AngularMap& map, int, const Vec2& px) {
  const double right = (px.x() - map.disc.cx) / map.disc.r, up = -(px.y() - map.disc.cy) / map.disc.r;
  const double rho = std::max(std::hypot(right, up), 1e-12), across = std::sin(kPi * rho) / rho;
  return Vec3(-across * right, across * up, std::cos(kPi * rho));
}

template <class Other>
Vec3 extended_dir(const Other&, int, const Vec2&) {
  return Vec3::UnitZ();
}

}  // namespace

Neighbourhood::Neighbourhood(View<const float> pixels, const Projection& projection)
    : pixels_(pixels), projection_(projection), kind_(Kind::kPlain) {
  boxes_ = {{0, 0, pixels.width(), pixels.height()}};
  if (std::holds_alternative<LatLong>(projection)) kind_ = Kind::kLatLong;
  if (const auto* map = std::get_if<Panorama>(&projection); map && map->closes()) kind_ = Kind::kAround;
  if (std::holds_alternative<Octahedral>(projection)) kind_ = Kind::kOctahedral;
  if (const auto disc = disc_of(projection)) {
    kind_ = std::holds_alternative<AngularMap>(projection) ? Kind::kContinued : Kind::kDisc;
    const auto* ball = std::get_if<MirrorBall>(&projection);
    discs_ = {ball ? outline_of(*ball) : circle_of(*disc)};
  }
  if (const auto* map = std::get_if<DualParaboloid>(&projection)) {
    kind_ = Kind::kContinued;
    const double r = 0.25 * map->size.width;
    boxes_.push_back(boxes_[0]);
    discs_ = {circle_of({r, r, r}), circle_of({3 * r, r, r})};
  }
  if (const auto* cube = std::get_if<Cube>(&projection)) {
    kind_ = Kind::kContinued;
    boxes_.clear();
    const int n = cube->face_px;
    for (const Cube::Face& f : cube->faces()) {
      boxes_.push_back({f.column * n, f.row * n, f.column * n + n, f.row * n + n});
    }
  }
  spans_.resize(boxes_.size());
  for (std::size_t region = 0; region < boxes_.size(); ++region) {
    for (int y = 0; y < pixels.height(); ++y) spans_[region].push_back(span_of(region, y));
  }
}

int Neighbourhood::region_of(const Vec2& px) const {
  if (boxes_.size() == 1) return 0;
  if (!discs_.empty()) return px.x() > 0.5 * pixels_.width() ? 1 : 0;
  for (std::size_t k = 0; k < boxes_.size(); ++k) {
    const PixelBox& b = boxes_[k];
    if (px.x() >= b.first_x && px.x() <= b.last_x && px.y() >= b.first_y && px.y() <= b.last_y) {
      return static_cast<int>(k);
    }
  }
  return 0;
}

bool Neighbourhood::is_plain(int region, const PixelBox& box) const {
  const auto k = static_cast<std::size_t>(region);
  const PixelBox& all = boxes_[k];
  if (box.first_x < all.first_x || box.first_y < all.first_y || box.last_x > all.last_x || box.last_y > all.last_y) {
    return false;
  }
  if (discs_.empty()) return true;
  // A box lies in an ellipse when its corners do.
  const Span top = plain_in_row(region, box.first_y), bottom = plain_in_row(region, box.last_y - 1);
  return box.first_x >= std::max(top.first, bottom.first) && box.last_x <= std::min(top.last, bottom.last);
}

/// A pixel lies in a disc when its whole square does.
Neighbourhood::Span Neighbourhood::span_of(std::size_t region, int y) const {
  const PixelBox& box = boxes_[region];
  if (y < box.first_y || y >= box.last_y) return {};
  if (discs_.empty()) return {box.first_x, box.last_x};
  // The squared distance from the squeezed disc's centre is a parabola of x.
  const Ellipse& disc = discs_[region];
  const auto squared = [&](double x) {
    return (disc.squeezed({disc.centre.x() + x, y + 0.5}) - disc.centre).squaredNorm();
  };
  const double at_0 = squared(0), at_1 = squared(1), at_minus_1 = squared(-1);
  const double a = 0.5 * (at_1 + at_minus_1) - at_0, b = 0.5 * (at_1 - at_minus_1);
  const double reach = std::max(0.0, disc.minor - kHalfDiagonal);
  const double middle = -b / (2 * a), half2 = middle * middle - (at_0 - reach * reach) / a;
  if (!(half2 >= 0)) return {};
  const double half = std::sqrt(half2), first = std::ceil(disc.centre.x() + middle - half - 0.5),
               last = std::floor(disc.centre.x() + middle + half - 0.5) + 1;
  const Span span{static_cast<int>(std::clamp(first, 1.0 * box.first_x, 1.0 * box.last_x)),
                  static_cast<int>(std::clamp(last, 1.0 * box.first_x, 1.0 * box.last_x))};
  return span.first < span.last ? span : Span{};
}

bool Neighbourhood::copy(int x, int y, float* value) const {
  const float* pixel = pixels_.pixel(x, y);
  for (int c = 0; c < pixels_.channels(); ++c) value[c] = pixel[c];
  return true;
}

bool Neighbourhood::tap(int region, int x, int y, float* value) const {
  const int width = pixels_.width(), height = pixels_.height();
  switch (kind_) {
    case Kind::kLatLong: {
      // Over the pole a row continues as itself, half a turn away.
      y %= 2 * height;
      if (y < 0) y += 2 * height;
      if (y >= height) {
        y = 2 * height - 1 - y;
        x += width / 2;
      }
      x %= width;
      return copy(x < 0 ? x + width : x, y, value);
    }
    case Kind::kAround:
      x %= width;
      return copy(x < 0 ? x + width : x, std::clamp(y, 0, height - 1), value);
    case Kind::kOctahedral: {
      // Each edge is folded in its middle.
      const auto fold = [](int& across, int& along, int size) {
        if (across >= 0 && across < size) return;
        across = std::clamp(across < 0 ? -1 - across : 2 * size - 1 - across, 0, size - 1);
        along = size - 1 - along;
      };
      fold(x, y, width);
      fold(y, x, height);
      return copy(std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1), value);
    }
    case Kind::kContinued:
      return is_plain(region, {x, y, x + 1, y + 1}) ? copy(x, y, value) : continued(region, x, y, value);
    case Kind::kDisc:
      return is_plain(0, {x, y, x + 1, y + 1}) && copy(x, y, value);
    case Kind::kPlain:
      break;
  }
  return copy(std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1), value);
}

/// Bilinear where the formula leads, from the pixels there that are whole.
bool Neighbourhood::continued(int region, int x, int y, float* value) const {
  const Vec3 dir =
      std::visit([&](const auto& p) { return extended_dir(p, region, Vec2(x + 0.5, y + 0.5)); }, projection_);
  const auto px = px_from_dir(projection_, dir);
  if (!px) return false;
  const auto there = static_cast<std::size_t>(region_of(*px));
  const PixelBox& box = boxes_[there];
  const double u = std::clamp(px->x() - 0.5, 1.0 * box.first_x, box.last_x - 1.0);
  const double v = std::clamp(px->y() - 0.5, 1.0 * box.first_y, box.last_y - 1.0);
  const int left = static_cast<int>(u), top = static_cast<int>(v);
  double total = 0;
  std::fill(value, value + pixels_.channels(), 0.0f);
  for (int k = 0; k < 4; ++k) {
    const int i = std::min(left + (k & 1), box.last_x - 1), j = std::min(top + (k >> 1), box.last_y - 1);
    const double weight = ((k & 1) ? u - left : 1 - (u - left)) * ((k >> 1) ? v - top : 1 - (v - top));
    if (weight <= 0 || (!discs_.empty() && !is_plain(static_cast<int>(there), {i, j, i + 1, j + 1}))) continue;
    total += weight;
    for (int c = 0; c < pixels_.channels(); ++c) value[c] += static_cast<float>(weight) * pixels_(i, j, c);
  }
  if (total < 0.05) return false;
  for (int c = 0; c < pixels_.channels(); ++c) value[c] /= static_cast<float>(total);
  return true;
}

}  // namespace hdr::internal
