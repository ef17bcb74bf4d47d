#include "tools/hdr/strata_picture.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/filter/resize.h"
#include "libhdr/filter/tonemap.h"

namespace hdr::tools {
namespace {

constexpr int kLargestWidth = 2048;

void mark(Image<std::uint8_t>& picture, int x, int y, std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  std::uint8_t* p = picture.pixel(x, y);
  p[0] = r;
  p[1] = g;
  p[2] = b;
}

void draw_edges(const Image<std::int32_t>& strata, Image<std::uint8_t>& picture) {
  const auto label = [&](int x, int y) {
    return strata(x * strata.width() / picture.width(), y * strata.height() / picture.height());
  };
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const int right = std::min(x + 1, picture.width() - 1), below = std::min(y + 1, picture.height() - 1);
      if (label(x, y) != label(right, y) || label(x, y) != label(x, below)) mark(picture, x, y, 255, 255, 255);
    }
  }
}

void draw_light(const DirectionalLight& light, double share, Image<std::uint8_t>& picture) {
  const Vec2 uv = latlong_from_dir(light.direction);
  const double cx = uv.x() * picture.width(), cy = uv.y() * picture.height();
  const double radius = std::clamp(std::sqrt(share) * 0.04 * picture.width(), 2.0, 0.02 * picture.width());
  for (int y = std::max(0, static_cast<int>(cy - radius - 1)); y <= cy + radius + 1 && y < picture.height(); ++y) {
    for (int x = static_cast<int>(std::floor(cx - radius - 1)); x <= cx + radius + 1; ++x) {
      const double away = std::hypot(x + 0.5 - cx, y + 0.5 - cy);
      const int around = (x + picture.width()) % picture.width();
      if (away <= radius) mark(picture, around, y, 255, 64, 32);
      if (away > radius && away <= radius + 1) mark(picture, around, y, 0, 0, 0);
    }
  }
}

}  // namespace

Image<std::uint8_t> strata_picture(View<const float> latlong, const Lights& lights) {
  const int width = std::clamp(latlong.width(), 512, kLargestWidth);
  const Image<float> map = resize(latlong, {width, std::max(1, width * latlong.height() / latlong.width())});
  Image<std::uint8_t> picture = tonemap(map, metered_stops(map));
  draw_edges(lights.strata, picture);
  double total = 0;
  for (const DirectionalLight& light : lights.lights) total += light.irradiance.sum();
  for (const DirectionalLight& light : lights.lights) {
    if (total > 0) draw_light(light, light.irradiance.sum() / total, picture);
  }
  return picture;
}

}  // namespace hdr::tools
