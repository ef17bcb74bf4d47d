#include "libhdr/probe/internal/source_picture.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"

namespace hdr::internal {
namespace {

constexpr double kHalfDiagonal = 0.7072;  ///< of a pixel: a centre this far inside the disc has its whole pixel inside

std::optional<Ellipse> disc_of(const Projection& projection) {
  if (const auto* map = std::get_if<AngularMap>(&projection))
    return Ellipse{{map->disc.cx, map->disc.cy}, {1, 0}, map->disc.r, map->disc.r};
  if (const auto* ball = std::get_if<MirrorBall>(&projection)) return outline_of(*ball);
  return std::nullopt;
}

/// The four taps of a bilinear sample, from (x, y) to (x + 1, y + 1).
struct Bilinear {
  int x, y;
  double weight[4];  ///< (x, y), (x+1, y), (x, y+1), (x+1, y+1)

  explicit Bilinear(const Vec2& px) {
    const double left = std::floor(px.x() - 0.5), top = std::floor(px.y() - 0.5);
    const double fx = px.x() - 0.5 - left, fy = px.y() - 0.5 - top;
    x = static_cast<int>(left);
    y = static_cast<int>(top);
    weight[0] = (1 - fx) * (1 - fy);
    weight[1] = fx * (1 - fy);
    weight[2] = (1 - fx) * fy;
    weight[3] = fx * fy;
  }
};

void add_weighted(const float* pixel, double weight, int channels, double* sum) {
  for (int c = 0; c < channels; ++c) sum[c] += weight * static_cast<double>(pixel[c]);
}

}  // namespace

SourcePicture::SourcePicture(View<const float> pixels, const Projection& projection)
    : pixels_(pixels), latlong_(std::holds_alternative<LatLong>(projection)), disc_(disc_of(projection)) {}

void SourcePicture::add(const Vec2& px, double* sum) const {
  if (disc_ && near_rim(px)) return add_inside_disc(px, sum);
  const Bilinear taps(px);
  const int last_x = pixels_.width() - 1, last_y = pixels_.height() - 1;
  const bool interior = taps.x >= 0 && taps.y >= 0 && taps.x < last_x && taps.y < last_y;
  for (int k = 0; k < 4; ++k) {
    const int x = taps.x + (k & 1), y = taps.y + (k >> 1);
    const float* pixel = interior   ? pixels_.pixel(x, y)
                         : latlong_ ? latlong_pixel(x, y)
                                    : pixels_.pixel(std::clamp(x, 0, last_x), std::clamp(y, 0, last_y));
    add_weighted(pixel, taps.weight[k], pixels_.channels(), sum);
  }
}

/// Over the pole a row continues as itself, half a turn away.
const float* SourcePicture::latlong_pixel(int x, int y) const {
  const int width = pixels_.width(), height = pixels_.height();
  if (y < 0 || y >= height) {
    y = std::clamp(y < 0 ? -1 - y : 2 * height - 1 - y, 0, height - 1);
    x += width / 2;
  }
  x %= width;
  return pixels_.pixel(x < 0 ? x + width : x, y);
}

bool SourcePicture::near_rim(const Vec2& px) const {
  const double reach = disc_->minor - kHalfDiagonal - std::numbers::sqrt2;  // within it all four taps are inside
  return reach <= 0 || (disc_->squeezed(px) - disc_->centre).squaredNorm() > reach * reach;
}

bool SourcePicture::in_disc(int x, int y) const {
  if (x < 0 || y < 0 || x >= pixels_.width() || y >= pixels_.height()) return false;
  const double reach = std::max(0.0, disc_->minor - kHalfDiagonal);
  return (disc_->squeezed({x + 0.5, y + 0.5}) - disc_->centre).squaredNorm() <= reach * reach;
}

/// The taps whose pixels are wholly inside the disc, their weights brought to 1. A position without such taps moves
/// towards the centre until it has one.
void SourcePicture::add_inside_disc(const Vec2& px, double* sum) const {
  constexpr double kLeastWeight = 0.25;
  const Vec2& centre = disc_->centre;
  Vec2 position = px;
  for (double moved = 0; moved <= disc_->major; moved += 0.5) {
    const Bilinear taps(position);
    double inside[4], total = 0;
    for (int k = 0; k < 4; ++k) {
      inside[k] = in_disc(taps.x + (k & 1), taps.y + (k >> 1)) ? taps.weight[k] : 0;
      total += inside[k];
    }
    if (total >= kLeastWeight) {
      for (int k = 0; k < 4; ++k) {
        if (inside[k] == 0) continue;
        add_weighted(pixels_.pixel(taps.x + (k & 1), taps.y + (k >> 1)), inside[k] / total, pixels_.channels(), sum);
      }
      return;
    }
    const double radius = (px - centre).norm();
    position = centre + (px - centre) * std::max(0.0, radius - moved - 0.5) / std::max(radius, 1e-9);
  }
  // A disc smaller than a pixel: the pixel that holds the position.
  const int x = std::clamp(static_cast<int>(px.x()), 0, pixels_.width() - 1);
  const int y = std::clamp(static_cast<int>(px.y()), 0, pixels_.height() - 1);
  add_weighted(pixels_.pixel(x, y), 1, pixels_.channels(), sum);
}

Vec2 SourcePicture::step(const Vec2& a, const Vec2& b) const {
  Vec2 d = b - a;
  const double width = pixels_.width();
  if (latlong_ && d.x() > 0.5 * width) d.x() -= width;
  if (latlong_ && d.x() < -0.5 * width) d.x() += width;
  return d;
}

double SourcePicture::distance(const Vec2& a, const Vec2& b) const {
  constexpr double kLeastShortening = 0.25;  // no pixel is missed but within 15 degrees of the poles
  Vec2 d = step(a, b);
  if (latlong_) d.x() *= std::max(kLeastShortening, std::sin(kPi * 0.5 * (a.y() + b.y()) / pixels_.height()));
  return d.norm();
}

}  // namespace hdr::internal
