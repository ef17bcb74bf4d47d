#include "libhdr/light/environment.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/solid_angle.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

constexpr double kBelowOne = 1 - 0x1p-53;

double pixel_luminance(const float* p) {
  return luminance<double>(p[0], p[1], p[2]);
}

// Share of the sphere above polar angle theta: (1 - cos theta) / 2, without the cancellation near the pole.
double share_above(double polar) {
  const double s = std::sin(0.5 * polar);
  return s * s;
}

// Running sums of `count` weights -> a distribution function from exactly 0 to exactly 1; all zero stays zero.
double normalise_running_sums(double* sums, int count) {
  const double total = sums[count];
  if (total > 0) std::transform(sums, sums + count + 1, sums, [&](double s) { return s / total; });
  return total;
}

// The step of a distribution function that u falls into. Steps of zero height are never met: u is in [low, high).
int step_of(const double* distribution, int count, double u) {
  const double* above = std::upper_bound(distribution, distribution + count + 1, u);
  return std::clamp(static_cast<int>(above - distribution) - 1, 0, count - 1);
}

double share_of_step(const double* distribution, int step, double u) {
  const double low = distribution[step], high = distribution[step + 1];
  return high > low ? std::clamp((u - low) / (high - low), 0.0, kBelowOne) : 0.5;
}

double inside_step(const double* distribution, int step, double share) {
  return std::min(distribution[step] + share * (distribution[step + 1] - distribution[step]), kBelowOne);
}

}  // namespace

Environment::Environment(Image<float> latlong) : map_(std::move(latlong)) {
  HDR_ASSERT(map_.channels() == 3 && !map_.empty());
  const int width = map_.width(), height = map_.height();
  marginal_.assign(static_cast<std::size_t>(height) + 1, 0);
  conditional_.assign(static_cast<std::size_t>(height) * (static_cast<std::size_t>(width) + 1), 0);
  std::vector<Rgb> row_sum(static_cast<std::size_t>(height), Rgb::Zero());
  std::vector<double> row_luminance(static_cast<std::size_t>(height), 0);
  for_rows(height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      double* sums = conditional_.data() + static_cast<std::ptrdiff_t>(y) * (width + 1);
      for (int x = 0; x < width; ++x) {
        const float* p = map_.pixel(x, y);
        sums[x + 1] = sums[x] + pixel_luminance(p);
        row_sum[static_cast<std::size_t>(y)] += Rgb(p[0], p[1], p[2]);
      }
      row_luminance[static_cast<std::size_t>(y)] = normalise_running_sums(sums, width);
    }
  });
  for (int y = 0; y < height; ++y) {
    const auto row = static_cast<std::size_t>(y);
    const double solid_angle = latlong_pixel_solid_angle(y, width, height);
    power_ += solid_angle * row_sum[row];
    marginal_[row + 1] = marginal_[row] + solid_angle * row_luminance[row];
  }
  total_ = normalise_running_sums(marginal_.data(), height);
  if (total_ > 0) return;
  // A black map: the same tables of a map of ones, which is uniform over the sphere.
  for (int y = 0; y <= height; ++y) {
    marginal_[static_cast<std::size_t>(y)] = y == height ? 1 : share_above(kPi * y / height);
    if (y == height) continue;
    double* row = conditional_.data() + static_cast<std::ptrdiff_t>(y) * (width + 1);
    for (int x = 0; x <= width; ++x) row[x] = static_cast<double>(x) / width;
  }
}

Environment Environment::from_probe(const RadianceMap& probe, const Projection& projection, int width) {
  if (std::holds_alternative<LatLong>(projection) && (width == 0 || width == probe.rgb.width())) {
    return Environment(probe.rgb.clone());
  }
  constexpr int kLargest = 16384;
  if (width == 0) {
    const double pixels_around = 2 * kPi / std::sqrt(solid_angle_in_middle(projection));
    width = std::clamp(2 * static_cast<int>(std::lround(0.5 * pixels_around)), 2, kLargest);
  }
  const Size size{width, std::max(1, width / 2)};
  return Environment(resample(probe.rgb, projection, LatLong{size}, size));
}

Environment::Sample Environment::sample_of(const Vec3f& dir, int x, int y) const {
  const float* p = map_.pixel(x, y);
  const double pdf = black() ? 0.25 / kPi : pixel_luminance(p) / total_;
  return {dir, Rgbf(p[0], p[1], p[2]), static_cast<float>(pdf)};
}

Environment::Sample Environment::sample(const Vec2& u) const {
  const int width = map_.width(), height = map_.height();
  const int y = step_of(marginal_.data(), height, u.y());
  const double* conditional = row_conditional(y);
  const int x = step_of(conditional, width, u.x());
  const double azimuth = 2 * kPi * (0.5 - (x + share_of_step(conditional, x, u.x())) / width);
  // Uniform in solid angle: linear in the share of the sphere above, h = sin^2(theta / 2).
  const double top = share_above(kPi * y / height), bottom = share_above(kPi * (y + 1) / height);
  const double h = top + share_of_step(marginal_.data(), y, u.y()) * (bottom - top);
  const double sine = 2 * std::sqrt(h * (1 - h));
  const Vec3 dir(sine * std::sin(azimuth), 1 - 2 * h, sine * std::cos(azimuth));
  return sample_of(dir.cast<float>(), x, y);
}

Environment::Pixel Environment::pixel_of(const Vec3f& dir) const {
  const int width = map_.width(), height = map_.height();
  const Vec2 uv = latlong_from_dir(dir.cast<double>());
  const double column = uv.x() * width;
  const int x = std::clamp(static_cast<int>(column), 0, width - 1);
  const int y = std::clamp(static_cast<int>(uv.y() * height), 0, height - 1);
  const double top = share_above(kPi * y / height), bottom = share_above(kPi * (y + 1) / height);
  const double below_top = (share_above(kPi * uv.y()) - top) / (bottom - top);
  return {x, y, {std::clamp(column - x, 0.0, 1.0), std::clamp(below_top, 0.0, 1.0)}};
}

Environment::Sample Environment::lookup(const Vec3f& dir) const {
  const Pixel pixel = pixel_of(dir);
  return sample_of(dir, pixel.x, pixel.y);
}

Vec2 Environment::invert(const Vec3f& dir) const {
  const Pixel pixel = pixel_of(dir);
  return {inside_step(row_conditional(pixel.y), pixel.x, pixel.inside.x()),
          inside_step(marginal_.data(), pixel.y, pixel.inside.y())};
}

}  // namespace hdr
