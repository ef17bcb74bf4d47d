#pragma once
// The two one-dimensional kernels of resampling, t in units of the kernel's
// scale: an output pixel where the picture is made smaller, a source pixel
// where it is not.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace hdr::internal {

/// std::floor and std::ceil are calls where they are not instructions.
inline int floor_of(double x) {
  const int towards_zero = static_cast<int>(x);
  return towards_zero - (static_cast<double>(towards_zero) > x);
}
inline int ceil_of(double x) {
  const int towards_zero = static_cast<int>(x);
  return towards_zero + (static_cast<double>(towards_zero) < x);
}

/// Cubic convolution on six points [Keys81]: a Hermite cubic through the
/// samples whose slopes are differences over five, (kNear, kFar) at distance 1
/// and 2. Keys's own slopes (-2/3, 1/12) are exact for polynomials of the
/// fourth degree; these are still exact for straight lines (kNear + 2 kFar =
/// -1/2) and closer to a sinc up to half of Nyquist. For what is made smaller:
/// scaled, it passes what the output can show and stops the rest.
struct SharpKernel {
  static constexpr float kReach = 3;
  static constexpr float kNear = -0.80f, kFar = 0.15f;
  static double at(double t) {
    t = std::abs(t);
    constexpr double n = kNear, f = kFar;
    if (t < 1) return 1 + t * t * ((2 + n) * t - (3 + n));
    if (t < 2) {
      const double u = t - 1;
      return u * (n + u * ((n + f) * u - (2 * n + f)));
    }
    if (t < 3) {
      const double u = t - 2;
      return u * f * (1 + u * (u - 2));
    }
    return 0;
  }
};

/// A sinc of eight points under a Kaiser window, its weights brought to 1: rms
/// error over all phases .16 % at a sixteenth of the sampling rate, .14 % at an
/// eighth, .28 % at a quarter, 5 % at .35 (Lanczos's window of that width: .26,
/// .38, .57, 2 %). For what is not made smaller.
class InterpolatingKernel {
 public:
  static constexpr float kReach = 4;
  /// From a table, within 1e-7.
  static double at(double t) {
    static const Table table;
    const double place = std::abs(t) * kSteps;
    if (place >= 4 * kSteps) return 0;
    const auto k = static_cast<std::size_t>(place);
    return table.values[k] + (place - static_cast<double>(k)) * (table.values[k + 1] - table.values[k]);
  }

 private:
  static constexpr int kSteps = 2048;  // a unit
  struct Table {
    std::array<double, 4 * kSteps + 2> values{};
    Table() {
      for (int k = 0; k < 4 * kSteps; ++k) values[static_cast<std::size_t>(k)] = exact(1.0 * k / kSteps);
    }
  };

  static double exact(double t) {
    constexpr double kBeta = 5;
    const double x = std::numbers::pi * t;
    const double sinc = std::abs(x) < 1e-9 ? 1 : std::sin(x) / x;
    return sinc * bessel_i0(kBeta * std::sqrt(1 - t * t / 16)) / bessel_i0(kBeta);
  }
  static double bessel_i0(double x) {
    double sum = 1, term = 1;
    for (int k = 1; term > 1e-12 * sum; ++k) {
      term *= 0.25 * x * x / (k * k);
      sum += term;
    }
    return sum;
  }
};

/// What a cubic spline through the samples [Unser93] weighs them by: the cardinal spline, cut where 1e-4 is left.
struct CardinalSplineKernel {
  static constexpr float kReach = 7;
  static double at(double t) {
    constexpr double kPole = std::numbers::sqrt3 - 2;
    double sum = 0, power = std::numbers::sqrt3;  // -6 z / (1 - z^2)
    for (int k = 0; k <= 8; ++k, power *= kPole) sum += power * (bspline(t - k) + (k > 0 ? bspline(t + k) : 0));
    return sum;
  }

 private:
  static double bspline(double t) {
    t = std::abs(t);
    if (t < 1) return 2.0 / 3 - t * t * (1 - 0.5 * t);
    return t < 2 ? (2 - t) * (2 - t) * (2 - t) / 6 : 0;
  }
};

/// Linear interpolation: it cannot ring, nor make what was positive negative.
struct TentKernel {
  static constexpr float kReach = 1;
  static double at(double t) { return std::max(0.0, 1 - std::abs(t)); }

  /// Of at((i - middle) * narrower) for i = first .. last, all where it is not 0: two arithmetic series, up to the
  /// middle and beyond it.
  static double sum(int first, int last, double middle, double narrower) {
    const int below = floor_of(middle);
    const double left = below - first + 1, right = last - below, past = middle - below;
    const double from_left = left * (past + 0.5 * (left - 1)), from_right = right * (0.5 * (right + 1) - past);
    return left + right - (from_left + from_right) * narrower;
  }
};

}  // namespace hdr::internal
