#include "libhdr/probe/internal/source_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libhdr/core/sphere.h"

namespace hdr::internal {
namespace {

constexpr int kMostChannels = 16;

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
    : pixels_(pixels), neighbourhood_(pixels, projection) {
  if (const auto disc = disc_of(projection)) middle_ = Vec2(disc->cx, disc->cy);
}

void SourcePicture::add(const Vec2& px, double* sum) const {
  const Bilinear taps(px);
  if (!neighbourhood_.is_plain(neighbourhood_.region_of(px), {taps.x, taps.y, taps.x + 2, taps.y + 2})) {
    return add_beside_edge(px, sum);
  }
  for (int k = 0; k < 4; ++k) {
    add_weighted(pixels_.pixel(taps.x + (k & 1), taps.y + (k >> 1)), taps.weight[k], pixels_.channels(), sum);
  }
}

/// The taps that there are, their weights brought to 1. A position without such taps moves towards the disc's centre
/// until it has one.
void SourcePicture::add_beside_edge(const Vec2& px, double* sum) const {
  constexpr double kLeastWeight = 0.25;
  const int region = neighbourhood_.region_of(px);
  std::array<std::array<float, kMostChannels>, 4> values;
  HDR_ASSERT(channels() <= kMostChannels);
  const Vec2 centre = middle_.value_or(px);
  const double radius = (px - centre).norm();
  for (double moved = 0; moved <= radius; moved += 0.5) {
    const Bilinear taps(moved == 0 ? px : Vec2(centre + (px - centre) * (radius - moved) / radius));
    double weights[4], total = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const bool shown = taps.weight[k] > 0 && neighbourhood_.tap(region, taps.x + static_cast<int>(k & 1),
                                                                  taps.y + static_cast<int>(k >> 1), values[k].data());
      weights[k] = shown ? taps.weight[k] : 0;
      total += weights[k];
    }
    if (total < kLeastWeight) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      if (weights[k] > 0) add_weighted(values[k].data(), weights[k] / total, channels(), sum);
    }
    return;
  }
  // A disc smaller than a pixel: the pixel that holds the position.
  const int x = std::clamp(static_cast<int>(px.x()), 0, pixels_.width() - 1);
  const int y = std::clamp(static_cast<int>(px.y()), 0, pixels_.height() - 1);
  add_weighted(pixels_.pixel(x, y), 1, pixels_.channels(), sum);
}

Vec2 SourcePicture::step(const Vec2& a, const Vec2& b) const {
  Vec2 d = b - a;
  const double width = pixels_.width();
  if (neighbourhood_.is_latlong() && d.x() > 0.5 * width) d.x() -= width;
  if (neighbourhood_.is_latlong() && d.x() < -0.5 * width) d.x() += width;
  return d;
}

double SourcePicture::distance(const Vec2& a, const Vec2& b) const {
  constexpr double kLeastShortening = 0.25;  // no pixel is missed but within 15 degrees of the poles
  Vec2 d = step(a, b);
  if (neighbourhood_.is_latlong())
    d.x() *= std::max(kLeastShortening, std::sin(kPi * 0.5 * (a.y() + b.y()) / pixels_.height()));
  return d.norm();
}

}  // namespace hdr::internal
