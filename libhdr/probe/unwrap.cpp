#include "libhdr/probe/unwrap.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"

namespace hdr {
namespace {

/// Whether a picture of this size shows every direction: then nobody needs to be told where it does not.
bool shows_everything(const Projection& from, Size size) {
  constexpr double kRounding = 1e-6;
  if (!shows_whole_sphere(from)) return false;
  if (const auto* ball = std::get_if<MirrorBall>(&from); ball && std::isfinite(ball->distance)) return false;
  const auto disc = disc_of(from);
  return !disc || (disc->cx - disc->r >= -kRounding && disc->cy - disc->r >= -kRounding &&
                   disc->cx + disc->r <= size.width + kRounding && disc->cy + disc->r <= size.height + kRounding);
}

/// Whether the output has a direction that is not shown.
bool lacks_something(View<const float> shown, const Projection& to) {
  const int lacking = reduce_rows(
      shown.height(), 16, 0,
      [&](int first, int last) {
        for (int y = first; y < last; ++y) {
          for (int x = 0; x < shown.width(); ++x) {
            if (shown(x, y) == 0 && dir_from_px(to, {x + 0.5, y + 0.5})) return 1;
          }
        }
        return 0;
      },
      [](int& total, int part) { total |= part; });
  return lacking != 0;
}

/// What a kernel with lobes makes of coverage is coverage still; where nothing is shown there is none.
void limit(Image<float>& alpha, View<const float> shown) {
  for_rows(alpha.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < alpha.width(); ++x) {
        alpha(x, y) = std::clamp(alpha(x, y), 0.0f, shown.empty() ? 1.0f : shown(x, y));
      }
    }
  });
}

}  // namespace

RadianceMap unwrap(const RadianceMap& source, const Projection& from, const Projection& to, Size size,
                   const Mat3& source_from_probe) {
  RadianceMap result;
  {
    const Resampler resampler(source.rgb, from, to, size, source_from_probe, source.stddev);
    result.rgb = Image<float>(size, source.rgb.channels());
    if (!source.stddev.empty()) result.stddev = Image<float>(size, source.stddev.channels());
    if (!shows_everything(from, source.size())) result.alpha = Image<float>(size, 1);
    resampler.rows(0, {result.rgb, result.alpha, result.stddev});
  }
  if (!result.alpha.empty() && !lacks_something(result.alpha, to)) result.alpha = {};
  if (!source.alpha.empty()) {
    Image<float> alpha = resample(source.alpha, from, to, size, source_from_probe);
    limit(alpha, result.alpha);
    result.alpha = std::move(alpha);
  }
  result.chromaticities = source.chromaticities;
  result.white_luminance = source.white_luminance;
  result.projection = text_from_projection(to);
  return result;
}

}  // namespace hdr
