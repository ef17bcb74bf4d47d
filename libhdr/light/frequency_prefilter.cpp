// What the bands that are left out can amount to. In band l no direction sees more than
//   |k_l| |L_l| sqrt((2l + 1) / 4 pi)         (Cauchy-Schwarz and the addition theorem; |L_l| the band's norm),
// which a single sun attains. Beyond kMaxShDegree the probe's bands are not known one by one: there it is the smaller
// of
//   norm of the lobe's rest times norm of the probe's rest    (soft probes) and
//   flux times the sum of |k_l| (2l + 1) / 4 pi to band 256, and from there on the first    (suns).
#include "libhdr/light/frequency_prefilter.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/lobe_kernel.h"
#include "libhdr/light/sh_latlong.h"
#include "libhdr/light/sh_reflect.h"

namespace hdr {
namespace {

constexpr int kFar = 256;  ///< bands of a lobe that are looked at

Rgb energy_of(View<const float> latlong) {
  return reduce_rows(
      latlong.height(), 16, Rgb(Rgb::Zero()),
      [&](int first, int last) {
        Rgb sum = Rgb::Zero();
        for (int y = first; y < last; ++y) {
          Rgb row = Rgb::Zero();
          for (int x = 0; x < latlong.width(); ++x) {
            const float* p = latlong.pixel(x, y);
            row += Rgb(p[0], p[1], p[2]).square();
          }
          sum += latlong_pixel_solid_angle(y, latlong.width(), latlong.height()) * row;
        }
        return sum;
      },
      [](Rgb& total, const Rgb& part) { total += part; });
}

// Energy and bands of a lobe that keeps a constant what it is.
struct LobeBands {
  std::vector<double> k;
  double energy;  ///< of the kernel over the sphere: sum of k_l^2 (2l + 1) / 4 pi over all l
};

double per_band(std::size_t l) {
  return (2 * static_cast<double>(l) + 1) / (4 * kPi);
}

LobeBands bands_of(Lobe lobe, double roughness) {
  const auto kernel = lobe_kernel(lobe, roughness);
  LobeBands bands{kernel_bands(kernel, kFar), 0};
  const double whole = bands.k[0];
  for (double& k : bands.k) k /= whole;
  bands.energy = kernel_bands([&](double t) { return std::pow(kernel(t) / whole, 2); }, 0)[0];
  return bands;
}

double norm_beyond(const LobeBands& bands, std::size_t degree) {
  double energy = bands.energy;
  for (std::size_t l = 0; l <= degree; ++l) energy -= bands.k[l] * bands.k[l] * per_band(l);
  return std::sqrt(std::max(0.0, energy) + 1e-14 * bands.energy);
}

Rgb largest_values(const Sh& sh) {
  const Image<float> map = latlong_of(sh, {128, 64});
  Rgb largest = Rgb::Zero();
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x)
      for (int c = 0; c < 3; ++c) largest[c] = std::max<double>(largest[c], map(x, y, c));
  return largest;
}

}  // namespace

FrequencyPrefilter::FrequencyPrefilter(View<const float> latlong)
    : light_(project(latlong, LatLong{latlong.size()}, kMaxShDegree)) {
  const Rgb energy = energy_of(latlong);
  energy_beyond_ = energy;
  for (const Rgb& c : light_.coefficients) energy_beyond_ -= c.square();
  energy_beyond_ = energy_beyond_.max(0.0) + 1e-13 * energy;  // what cancels is known to the rounding of sums
  flux_ = light_(0, 0) * std::sqrt(4 * kPi);
}

FrequencyPrefilter::Level FrequencyPrefilter::level(double roughness, Lobe lobe, double error) const {
  HDR_ASSERT(roughness > 0 && roughness <= 1 && error > 0);
  const LobeBands bands = bands_of(lobe, roughness);
  double far_sum = 0;
  for (std::size_t l = kMaxShDegree + 1; l <= kFar; ++l) far_sum += std::abs(bands.k[l]) * per_band(l);
  const Rgb norm = energy_beyond_.sqrt();
  Rgb left_out = (norm_beyond(bands, kMaxShDegree) * norm).min(flux_ * far_sum + norm_beyond(bands, kFar) * norm);

  // The largest value is no less than what the table shows but for what is left out, nor than the mean.
  const Sh full = convolved(light_, {bands.k.begin(), bands.k.begin() + kMaxShDegree + 1});
  const Rgb largest = (largest_values(full) - left_out).max(flux_ / (4 * kPi));
  const auto relative = [&](const Rgb& off) {
    double worst = 0;
    for (int c = 0; c < 3; ++c)
      if (flux_[c] > 0) worst = std::max(worst, off[c] / largest[c]);
    return worst;
  };

  Level level{full, relative(left_out), false};
  level.met = level.bound <= error;
  while (level.met && level.sh.degree > 0) {
    const int l = level.sh.degree;
    Rgb square = Rgb::Zero();
    for (int m = -l; m <= l; ++m) square += full(l, m).square();
    left_out += (square * per_band(static_cast<std::size_t>(l))).sqrt();
    if (relative(left_out) > error) break;
    level.bound = relative(left_out);
    level.sh.degree = l - 1;
    level.sh.coefficients.resize(static_cast<std::size_t>(l) * static_cast<std::size_t>(l));
  }
  return level;
}

}  // namespace hdr
