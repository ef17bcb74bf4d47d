#include "libhdr/light/prefilter.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/cube.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

// Half as many columns and rows; each pixel the mean of its four by solid angle. Odd sizes drop nothing: the last pixel
// has three columns or rows.
Image<float> halved(View<const float> map) {
  const Size size{std::max(1, map.width() / 2), std::max(1, map.height() / 2)};
  Image<float> half(size, 3);
  for_rows(size.height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const int y0 = y * map.height() / size.height, y1 = (y + 1) * map.height() / size.height;
      for (int x = 0; x < size.width; ++x) {
        const int x0 = x * map.width() / size.width, x1 = (x + 1) * map.width() / size.width;
        Rgb sum = Rgb::Zero();
        double weight = 0;
        for (int j = y0; j < y1; ++j) {
          const double solid_angle = latlong_pixel_solid_angle(j, map.width(), map.height());
          for (int i = x0; i < x1; ++i) {
            const float* p = map.pixel(i, j);
            sum += solid_angle * Rgb(p[0], p[1], p[2]);
            weight += solid_angle;
          }
        }
        for (int c = 0; c < 3; ++c) half(x, y, c) = static_cast<float>(sum[c] / weight);
      }
    }
  });
  return half;
}

// Van der Corput's sequence in base 2: with k / n it makes Hammersley's points.
double radical_inverse(std::uint32_t k) {
  double value = 0, digit = 0.5;
  for (; k; k >>= 1, digit *= 0.5) value += (k & 1) * digit;
  return value;
}

}  // namespace

Prefilter::Prefilter(View<const float> latlong) {
  HDR_ASSERT(latlong.channels() == 3 && !latlong.empty());
  Image<float> finest(latlong.size(), 3);
  for (int y = 0; y < latlong.height(); ++y) std::copy_n(latlong.row(y), 3 * latlong.width(), finest.row(y));
  levels_.push_back(std::move(finest));
  while (levels_.back().width() > 1 || levels_.back().height() > 1) levels_.push_back(halved(levels_.back()));
}

// Directions l around n = +Z with their weights and the solid angle each stands for, 1 / (count pdf).
std::vector<Prefilter::Sample> Prefilter::samples_of(double roughness, Lobe lobe, int count) const {
  const double alpha = std::max(roughness * roughness, 1e-4), alpha2 = alpha * alpha;
  std::vector<Sample> samples;
  for (int k = 0; k < count; ++k) {
    const double u = (k + 0.5) / count, phi = 2 * kPi * radical_inverse(static_cast<std::uint32_t>(k));
    Sample sample;
    double cosine = 0, pdf = 0;
    if (lobe == Lobe::kGgx) {
      // Half vectors by D(h) (n.h); seen head-on, v = n, the density of l is D(h) (n.h) / (4 v.h) = D / 4.
      const double cos2 = (1 - u) / (1 + (alpha2 - 1) * u);
      const double t = cos2 * (alpha2 - 1) + 1;
      pdf = alpha2 / (kPi * t * t) / 4;
      cosine = 2 * cos2 - 1;  // l is h mirrored: twice its angle
      sample.weight = cosine;
    } else {
      const double power = 2 / alpha2 - 2;
      cosine = std::pow(1 - u, 1 / (power + 1));
      pdf = (power + 1) / (2 * kPi) * std::pow(cosine, power);
      sample.weight = 1;
    }
    if (cosine <= 0) continue;
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    sample.dir = {sine * std::cos(phi), sine * std::sin(phi), cosine};
    sample.solid_angle = 1 / (count * pdf);
    samples.push_back(sample);
  }
  return samples;
}

Rgb Prefilter::bilinear(const Vec3& dir, std::size_t level) const {
  const Image<float>& map = levels_[level];
  const Vec2 uv = latlong_from_dir(dir);
  const double x = uv.x() * map.width() - 0.5, y = std::clamp(uv.y() * map.height() - 0.5, 0.0, map.height() - 1.0);
  const double column = std::floor(x);
  const int x0 = (static_cast<int>(column) + map.width()) % map.width(), x1 = (x0 + 1) % map.width();
  const int y0 = static_cast<int>(y), y1 = std::min(y0 + 1, map.height() - 1);
  const double fx = x - column, fy = y - y0;
  const auto at = [&map](int i, int j) {
    const float* p = map.pixel(i, j);
    return Rgb(p[0], p[1], p[2]);
  };
  return (at(x0, y0) * (1 - fx) + at(x1, y0) * fx) * (1 - fy) + (at(x0, y1) * (1 - fx) + at(x1, y1) * fx) * fy;
}

// The level whose pixels show that solid angle, between two. Towards the poles pixels grow narrow; their height stays,
// and so it decides.
Rgb Prefilter::blurred(const Vec3& dir, double solid_angle) const {
  const double pixel = kPi / levels_[0].height();
  const double level = std::log2(std::max(1.0, std::sqrt(solid_angle) / pixel));
  const auto highest = levels_.size() - 1;
  const auto low = std::min(static_cast<std::size_t>(level), highest), high = std::min(low + 1, highest);
  const double share = std::clamp(level - static_cast<double>(low), 0.0, 1.0);
  return bilinear(dir, low) * (1 - share) + bilinear(dir, high) * share;
}

Rgb Prefilter::mean_of(const Vec3& dir, const std::vector<Sample>& samples) const {
  Vec3f t, b;
  tangents_from_normal(dir.cast<float>(), t, b);
  const Vec3 x = t.cast<double>(), y = b.cast<double>();
  Rgb sum = Rgb::Zero();
  double weight = 0;
  for (const Sample& sample : samples) {
    const Vec3 l = sample.dir.x() * x + sample.dir.y() * y + sample.dir.z() * dir;
    sum += sample.weight * blurred(l.normalized(), sample.solid_angle);
    weight += sample.weight;
  }
  return weight > 0 ? Rgb(sum / weight) : bilinear(dir, 0);
}

Rgb Prefilter::mean(const Vec3& dir, double roughness, Lobe lobe, int samples) const {
  HDR_ASSERT(roughness >= 0 && roughness <= 1 && samples > 0);
  if (roughness == 0) return bilinear(dir, 0);
  return mean_of(dir, samples_of(roughness, lobe, samples));
}

Image<float> Prefilter::latlong(Size size, double roughness, Lobe lobe, int samples) const {
  HDR_ASSERT(roughness >= 0 && roughness <= 1 && samples > 0);
  if (roughness == 0) return resample(levels_[0], LatLong{levels_[0].size()}, LatLong{size}, size);
  const std::vector<Sample> directions = samples_of(roughness, lobe, samples);
  Image<float> map(size, 3);
  for_rows(size.height, 2, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const Rgb value = mean_of(dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height), directions);
        for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(value[c]);
      }
    }
  });
  return map;
}

std::array<Image<float>, 6> Prefilter::cube(int width, double roughness, Lobe lobe, int samples) const {
  HDR_ASSERT(width > 0 && roughness >= 0 && roughness <= 1 && samples > 0);
  if (roughness == 0) {
    // A face's middle pixel, the largest, is 2 / width wide.
    const double pixel = 4.0 / (static_cast<double>(width) * width);
    return cube_map(width, [&](const Vec3& dir) { return blurred(dir, pixel); });
  }
  const std::vector<Sample> directions = samples_of(roughness, lobe, samples);
  return cube_map(width, [&](const Vec3& dir) { return mean_of(dir, directions); });
}

}  // namespace hdr
