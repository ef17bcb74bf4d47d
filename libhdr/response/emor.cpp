// [Grossberg04] Modeling the Space of Camera Response Functions: a curve of the family, and its inverse.
#include "libhdr/response/internal/emor.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

constexpr double kGrain = 1.0 / 1023;  ///< the distance of the published samples
constexpr int kDense = 1024;           ///< points at which the curve is made to rise
/// What a held curve still rises by, per unit of x, so that it has an inverse: less than the code of a 16-bit
/// photograph.
constexpr double kLeastSlope = 1e-6;

/// Cubic splines through the columns of the basis, in x = ln(E + grain): the mean first, then the components.
struct Splines {
  Eigen::VectorXd x;
  Eigen::MatrixXd values, bends;  ///< samples x (1 + components); bends are second derivatives

  Splines() : x(kEmorSamples), values(kEmorSamples, 1 + kEmorComponents) {
    for (int k = 0; k < kEmorSamples; ++k) {
      const EmorSample& sample = kEmorBasis[static_cast<std::size_t>(k)];
      x[k] = std::log(sample.exposure + kGrain);
      values(k, 0) = sample.mean;
      for (int n = 0; n < kEmorComponents; ++n) values(k, 1 + n) = sample.components[static_cast<std::size_t>(n)];
    }
    // The slope is continuous: h- M- + 2 (h- + h+) M + h+ M+ = 6 (rise+ / h+ - rise- / h-). The first two pieces are
    // one cubic, and so are the last two: the responses do not straighten at their ends, as natural splines would.
    Eigen::MatrixXd system = Eigen::MatrixXd::Identity(kEmorSamples, kEmorSamples);
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(kEmorSamples, 1 + kEmorComponents);
    for (int k = 1; k + 1 < kEmorSamples; ++k) {
      const double before = x[k] - x[k - 1], after = x[k + 1] - x[k];
      system.row(k).segment<3>(k - 1) << before, 2 * (before + after), after;
      right.row(k) = 6 * ((values.row(k + 1) - values.row(k)) / after - (values.row(k) - values.row(k - 1)) / before);
    }
    const auto one_cubic = [&](int row, int first) {
      const double before = x[first + 1] - x[first], after = x[first + 2] - x[first + 1];
      system.row(row).setZero();
      system.row(row).segment<3>(first) << after, -(before + after), before;
    };
    one_cubic(0, 0);
    one_cubic(kEmorSamples - 1, kEmorSamples - 3);
    bends = system.partialPivLu().solve(right);
  }

  double low() const { return x[0]; }
  double high() const { return x[kEmorSamples - 1]; }
};

const Splines& splines() {
  static const Splines instance;
  return instance;
}

/// The value and slope at `x` of a spline are these weights times its two nearest values and bends.
struct Cell {
  int k;
  double value[4], slope[4];

  explicit Cell(double at) {
    const Eigen::VectorXd& x = splines().x;
    const auto above = std::upper_bound(x.data(), x.data() + x.size(), at);
    k = std::clamp(static_cast<int>(above - x.data()) - 1, 0, kEmorSamples - 2);
    const double h = x[k + 1] - x[k], b = (at - x[k]) / h, a = 1 - b;
    value[0] = a;
    value[1] = b;
    value[2] = (a * a * a - a) * h * h / 6;
    value[3] = (b * b * b - b) * h * h / 6;
    slope[0] = -1 / h;
    slope[1] = 1 / h;
    slope[2] = (1 - 3 * a * a) * h / 6;
    slope[3] = (3 * b * b - 1) * h / 6;
  }

  template <class Values, class Bends>
  double apply(const double (&w)[4], const Values& values, const Bends& bends) const {
    return w[0] * values[k] + w[1] * values[k + 1] + w[2] * bends[k] + w[3] * bends[k + 1];
  }
};

double x_of(double step, int count) {
  return splines().low() + (splines().high() - splines().low()) * step / (count - 1);
}

}  // namespace

EmorCurve::EmorCurve(const Eigen::VectorXd& coefficients) : coefficients_(coefficients) {
  HDR_ASSERT(coefficients.size() <= kEmorComponents);
  const Splines& s = splines();
  nodes_ = s.values.col(0) + s.values.middleCols(1, coefficients.size()) * coefficients;
  bends_ = s.bends.col(0) + s.bends.middleCols(1, coefficients.size()) * coefficients;
  held_.resize(kDense);
  const double least_rise = kLeastSlope * (s.high() - s.low()) / (kDense - 1);
  for (int k = 0; k < kDense; ++k) {
    const Cell cell(x_of(k, kDense));
    const double sum = cell.apply(cell.value, nodes_, bends_);
    held_[k] = k == 0 ? sum : std::max(sum, held_[k - 1] + least_rise);
  }
}

double EmorCurve::value(double exposure) const {
  const Splines& s = splines();
  const double place = (std::log(exposure + kGrain) - s.low()) / (s.high() - s.low()) * (kDense - 1);
  const int below = std::clamp(static_cast<int>(place), 0, kDense - 2);
  return held_[below] + (place - below) * (held_[below + 1] - held_[below]);
}

double EmorCurve::ln_exposure(double value) const {
  const auto above = std::upper_bound(held_.begin(), held_.end(), value);
  const int below = std::clamp(static_cast<int>(above - held_.begin()) - 1, 0, kDense - 2);
  const double share = std::clamp((value - held_[below]) / (held_[below + 1] - held_[below]), 0.0, 1.0);
  const double left = x_of(below, kDense), right = x_of(below + 1, kDense);
  double x = left + share * (right - left);
  // Two steps of Newton make the inverse as smooth as the spline; where the curve is held there is nothing to refine.
  for (int step = 0; step < 2; ++step) {
    const Cell cell(x);
    const double slope = cell.apply(cell.slope, nodes_, bends_);
    if (!(slope > kLeastSlope)) break;
    x = std::clamp(x - (cell.apply(cell.value, nodes_, bends_) - value) / slope, left, right);
  }
  // Below the first dense point no light is told from a little: half of that point's.
  const double dimmest = 0.5 * (std::exp(x_of(1, kDense)) - kGrain);
  return std::log(std::max(dimmest, std::exp(x) - kGrain));
}

double EmorCurve::slope(double ln_exposure) const {
  const double exposure = std::exp(ln_exposure);
  const Cell cell(std::log(exposure + kGrain));
  // df/d ln E = df/dx dx/d ln E, and dx/d ln E = E / (E + grain).
  return std::max(kLeastSlope, cell.apply(cell.slope, nodes_, bends_)) * exposure / (exposure + kGrain);
}

Eigen::VectorXd EmorCurve::gradient(double ln_exposure) const {
  const Cell cell(std::log(std::exp(ln_exposure) + kGrain));
  const double df = slope(ln_exposure);
  Eigen::VectorXd gradient(components());
  for (int n = 0; n < components(); ++n) {
    gradient[n] = -cell.apply(cell.value, splines().values.col(1 + n), splines().bends.col(1 + n)) / df;
  }
  return gradient;
}

Eigen::VectorXd EmorCurve::slopes(int count) const {
  Eigen::VectorXd slopes(count);
  for (int k = 0; k < count; ++k) {
    const Cell cell(x_of(k, count));
    slopes[k] = cell.apply(cell.slope, nodes_, bends_);
  }
  return slopes;
}

Eigen::MatrixXd EmorCurve::slopes_of_components(int count) {
  Eigen::MatrixXd slopes(count, kEmorComponents);
  for (int k = 0; k < count; ++k) {
    const Cell cell(x_of(k, count));
    for (int n = 0; n < kEmorComponents; ++n) {
      slopes(k, n) = cell.apply(cell.slope, splines().values.col(1 + n), splines().bends.col(1 + n));
    }
  }
  return slopes;
}

}  // namespace hdr
