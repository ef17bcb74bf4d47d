// How wrong the irradiance of a short expansion can be. With A the clamped cosine and A_n its first n bands,
//   E(n) - E_degree(n) = sum over degree < l <= D of A_l sum_m L_lm Y_lm(n)  +  integral of L (A - A_D)(n.w).
// The first part is evaluated on a grid of normals; the second is bounded twice, and the smaller bound is taken:
//   Cauchy-Schwarz: norm of A - A_D times norm of what L has beyond degree D (small for soft maps);
//   L >= 0:         largest |A - A_D| times the integral of L (small for maps that a few suns rule).
#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/clamped_cosine.h"
#include "libhdr/light/internal/project.h"

namespace hdr {
namespace {

constexpr int kBoundDegree = 12;

// Squared norm over the sphere of A - A_D: that of max(cos, 0) is 2 pi / 3 (Parseval).
double cosine_energy_beyond(int degree) {
  double energy = 2 * kPi / 3;
  for (int l = 0; l <= degree; ++l) {
    const double a = clamped_cosine_coefficient(l);
    energy -= a * a * (2 * l + 1) / (4 * kPi);
  }
  return energy;
}

// Largest |A - A_D| over angles. Between samples it can rise by half a step times its slope: 1 of the cosine, and D
// times its size (below 1.1) of a trigonometric polynomial of degree D (Bernstein).
double cosine_residual_max(int degree) {
  constexpr int kSteps = 40000;
  double largest = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double t = std::cos(kPi * i / kSteps);
    double previous = 0, p = 1, series = 0;
    for (int l = 0; l <= degree; ++l) {
      series += clamped_cosine_coefficient(l) * (2 * l + 1) / (4 * kPi) * p;
      const double next = ((2 * l + 1) * t * p - l * previous) / (l + 1);
      previous = p;
      p = next;
    }
    largest = std::max(largest, std::abs(std::max(t, 0.0) - series));
  }
  return largest + 0.5 * kPi / kSteps * (1 + 1.1 * degree);
}

// Integral of L^2 over the sphere. The map is scaled by `unit` first so that no square leaves the range of a float.
Rgb energy_of(View<const float> rgb, const Projection& projection, double unit) {
  Image<float> square(rgb.size(), 3);
  for (int y = 0; y < rgb.height(); ++y) {
    for (int i = 0; i < 3 * rgb.width(); ++i) {
      const double value = rgb.row(y)[i] / unit;
      square.row(y)[i] = static_cast<float>(value * value);
    }
  }
  return project(square, projection, 0)(0, 0) * std::sqrt(4 * kPi) * (unit * unit);
}

double largest_sample(View<const float> rgb) {
  double largest = 0;
  for (int y = 0; y < rgb.height(); ++y)
    for (int i = 0; i < 3 * rgb.width(); ++i) largest = std::max<double>(largest, rgb.row(y)[i]);
  return largest;
}

struct GridMaxima {
  Rgb irradiance = Rgb::Zero();  ///< largest E of the short expansion
  Rgb omitted = Rgb::Zero();     ///< largest |contribution| of the bands up to kBoundDegree that it leaves out
};

// No point is farther than `reach` from a normal of the grid, and around its maximum M a trigonometric polynomial of
// degree D is at least M cos(D t) (M. Riesz): the grid's maximum divided by cos(D reach) bounds the true one.
GridMaxima maxima_over_normals(const Sh& sh, const Sh& omitted) {
  constexpr int kWidth = 240, kHeight = 120;
  constexpr double kReach = 0.5 * kPi / kHeight * std::numbers::sqrt2;
  GridMaxima maxima;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec3 n = dir_from_latlong((x + 0.5) / kWidth, (y + 0.5) / kHeight);
      maxima.irradiance = maxima.irradiance.max(irradiance(sh, n));
      maxima.omitted = maxima.omitted.max(irradiance(omitted, n).abs());
    }
  }
  maxima.omitted /= std::cos(omitted.degree * kReach);
  return maxima;
}

// What a bound needs to know of a map, once.
class Analysis {
 public:
  Analysis(View<const float> rgb, const Projection& projection, int degree)
      : unit_(largest_sample(rgb)), black_(unit_ <= 0) {
    if (black_) return;
    full_ = project(rgb, projection, std::max(kBoundDegree, degree));
    const Rgb energy = energy_of(rgb, projection, unit_);
    flux_ = full_(0, 0) * std::sqrt(4 * kPi);
    Rgb left = energy;
    for (const Rgb& c : full_.coefficients) left -= c.square();
    // What cancels in the difference is known to a few parts in 1e7: squares were rounded to float.
    left = left.max(0.0) + 1e-7 * energy;
    tail_ = (cosine_energy_beyond(full_.degree) * left).sqrt().min(cosine_residual_max(full_.degree) * flux_);
  }

  bool black() const { return black_; }
  Sh truncated(int degree) const {
    return {degree, {full_.coefficients.begin(), full_.coefficients.begin() + sh_count(degree)}};
  }

  double bound_of(const Sh& sh) const {
    if (black_) return 0;
    Sh omitted = full_;
    for (std::size_t k = 0; k < sh.coefficients.size(); ++k) omitted.coefficients[k] -= sh.coefficients[k];
    const GridMaxima maxima = maxima_over_normals(sh, omitted);
    double bound = 0;
    for (int c = 0; c < 3; ++c) {
      if (flux_[c] > 0) bound = std::max(bound, (maxima.omitted[c] + tail_[c]) / maxima.irradiance[c]);
    }
    return bound;
  }

 private:
  double unit_;
  bool black_;
  Sh full_;
  Rgb flux_ = Rgb::Zero(), tail_ = Rgb::Zero();
};

}  // namespace

double irradiance_error_bound(View<const float> rgb, const Projection& projection, const Sh& sh) {
  return Analysis(rgb, projection, sh.degree).bound_of(sh);
}

ChosenSh project_within(View<const float> rgb, const Projection& projection, double error) {
  HDR_ASSERT(error > 0);
  const Analysis analysis(rgb, projection, 0);
  if (analysis.black()) return {{0, {Rgb::Zero()}}, 0, true};
  ChosenSh chosen;
  // Above 1 odd bands of the clamped cosine vanish: they would add coefficients and no irradiance.
  for (const int degree : {0, 1, 2, 4, 6, 8, 10, 12}) {
    chosen.sh = analysis.truncated(degree);
    chosen.bound = analysis.bound_of(chosen.sh);
    if (chosen.bound <= error) return chosen;
  }
  chosen.met = false;
  return chosen;
}

}  // namespace hdr
