#include "libhdr/render/texture.h"

#include <algorithm>
#include <cmath>

namespace hdr {
namespace {

int wrapped(int texel, int count, Wrap wrap) {
  if (wrap == Wrap::kClamp) return std::clamp(texel, 0, count - 1);
  const int period = wrap == Wrap::kMirror ? 2 * count : count;
  const int within = (texel % period + period) % period;
  return within < count ? within : period - 1 - within;
}

// Far coordinates are brought near first, where a float still has room for the place between two texels.
float near_zero(float t) {
  constexpr float kPeriods = 2;  // of the mirrored wrap too
  return t - kPeriods * std::floor(t / kPeriods);
}

}  // namespace

Rgbf Texture::at(const Vec2f& uv) const {
  const auto along = [](float t, int count, Wrap wrap) {
    if (!std::isfinite(t)) return 0.0f;
    const float inside = wrap == Wrap::kClamp ? std::clamp(t, 0.0f, 1.0f) : near_zero(t);
    return inside * static_cast<float>(count) - 0.5f;
  };
  const int width = texels.width(), height = texels.height();
  const float x = along(uv.x(), width, wrap_u), y = along(1 - uv.y(), height, wrap_v);
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  const float right_share = x - static_cast<float>(left), low_share = y - static_cast<float>(top);
  const auto texel = [&](int dx, int dy) -> Rgbf {
    const float* p = texels.pixel(wrapped(left + dx, width, wrap_u), wrapped(top + dy, height, wrap_v));
    return {p[0], p[1], p[2]};
  };
  const Rgbf upper = (1 - right_share) * texel(0, 0) + right_share * texel(1, 0);
  const Rgbf lower = (1 - right_share) * texel(0, 1) + right_share * texel(1, 1);
  return (1 - low_share) * upper + low_share * lower;
}

}  // namespace hdr
