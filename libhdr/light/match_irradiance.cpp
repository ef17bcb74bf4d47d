// Irradiance is smooth: few bands of the light decide nearly all of it [Ramamoorthi01]. Band 0 the lights keep by
// carrying all of their regions' light, 3, 5 and 7 have none, and bands 1, 2, 4, 6 and 8 are 47 numbers for each of
// three channels that small turns of N directions can set. With residual r of the irradiance's coefficients and their
// slopes J, the least turns t, in units of each light's reach, that mend it minimise
//   |r - J t|^2 + lambda |t|^2,   t = J' (J J' + lambda)^-1 r:
// a 141 x 141 system for any N (Levenberg-Marquardt in its dual form: a turn that does not help is tried again,
// shorter). By Parseval |r|^2 is the mean square error of the irradiance over all normals. The three "channels" are
// luminance and, at a quarter of its weight, two differences of colours: eyes see the first.
#include "libhdr/light/internal/match_irradiance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/clamped_cosine.h"
#include "libhdr/light/sh.h"

namespace hdr {
namespace {

constexpr int kDegree = 8, kBasis = (kDegree + 1) * (kDegree + 1), kUsed = 3 + 5 + 9 + 13 + 17;
constexpr double kCost = 1e-4;    ///< a turn by its whole reach is worth this share of the mean irradiance
constexpr double kLongest = 1e4;  ///< the largest lambda that is tried, relative to the least
constexpr int kSteps = 40;

/// Coefficients of the irradiance, relative to its mean: bands 1, 2, 4, 6, 8.
using Coefficients = Eigen::Matrix<double, 3 * kUsed, 1>;

Rgb seen_by_eyes(const Rgb& light) {
  constexpr double kColour = 0.25;
  return {luminance(light[0], light[1], light[2]), kColour * (light[0] - light[1]), kColour * (light[2] - light[1])};
}

void add(const Vec3& dir, const Rgb& light, Coefficients& sum) {
  double y[kBasis];
  sh_basis(dir, kDegree, y);
  int row = 0;
  for (const int l : {1, 2, 4, 6, 8}) {
    const double a = clamped_cosine_coefficient(l);
    for (int k = l * l; k < (l + 1) * (l + 1); ++k)
      for (int c = 0; c < 3; ++c) sum[row++] += a * y[k] * light[c];
  }
}

// Of luminance: a quarter of the flux.
double mean_irradiance(const LightCells& cells) {
  double flux = 0;
  for (const LightCell& cell : cells.cells) flux += cell.luminance;
  return flux / 4;
}

class Matcher {
 public:
  Matcher(const LightCells& cells, const std::vector<double>& reach, std::vector<DirectionalLight>& lights)
      : reach_(reach), lights_(lights), mean_(mean_irradiance(cells)) {
    for (const LightCell& cell : cells.cells) {
      if (!(cell.luminance > 0)) continue;
      // A cell's light comes from where it is brightest: that of its sun, not of its middle.
      const double length = cell.moment.norm();
      add(length > 0 ? Vec3(cell.moment / length) : cell.middle, seen_by_eyes(cell.light) / mean_, wanted_);
    }
    for (const DirectionalLight& light : lights) start_.push_back(light.direction);
  }

  void run() {
    double error = residual().squaredNorm();
    double damping = 1;
    for (int step = 0; step < kSteps && damping <= kLongest * kLongest; ++step) {
      const std::vector<DirectionalLight> before = lights_;
      turn(kCost * kCost * damping);
      const double now = residual().squaredNorm();
      if (now < error) {
        if (now > 0.99 * error) return;
        error = now;
        damping = std::max(1.0, damping / 4);
      } else {
        lights_ = before;
        damping *= 10;
      }
    }
  }

 private:
  Coefficients residual() const {
    Coefficients r = wanted_;
    for (const DirectionalLight& light : lights_) add(light.direction, -seen_by_eyes(light.irradiance) / mean_, r);
    return r;
  }

  void turn(double lambda) {
    const auto count = static_cast<Eigen::Index>(lights_.size());
    Eigen::MatrixXd slopes(3 * kUsed, 2 * count);
    std::vector<std::array<Vec3, 2>> tangents;
    for (Eigen::Index i = 0; i < count; ++i) {
      const DirectionalLight& light = lights_[static_cast<std::size_t>(i)];
      Vec3f t, b;
      tangents_from_normal(light.direction.cast<float>(), t, b);
      tangents.push_back({t.cast<double>(), b.cast<double>()});
      for (int way = 0; way < 2; ++way)
        slopes.col(2 * i + way) =
            slope(light, tangents.back()[static_cast<std::size_t>(way)]) * reach_[static_cast<std::size_t>(i)];
    }
    Eigen::MatrixXd system = lambda * Eigen::MatrixXd::Identity(3 * kUsed, 3 * kUsed);
    system.selfadjointView<Eigen::Lower>().rankUpdate(slopes);
    const Eigen::VectorXd turns = slopes.transpose() * system.selfadjointView<Eigen::Lower>().ldlt().solve(residual());
    for (std::size_t i = 0; i < lights_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(2 * i);
      const Vec3 moved = lights_[i].direction + reach_[i] * (turns[k] * tangents[i][0] + turns[k + 1] * tangents[i][1]);
      lights_[i].direction = within(moved.normalized(), start_[i], reach_[i]);
    }
  }

  Coefficients slope(const DirectionalLight& light, const Vec3& way) const {
    constexpr double kStep = 1e-4;
    Coefficients change = Coefficients::Zero();
    add((light.direction + kStep * way).normalized(), seen_by_eyes(light.irradiance) / (2 * kStep * mean_), change);
    add((light.direction - kStep * way).normalized(), -seen_by_eyes(light.irradiance) / (2 * kStep * mean_), change);
    return change;
  }

  static Vec3 within(const Vec3& dir, const Vec3& start, double reach) {
    const double away = std::acos(std::clamp(dir.dot(start), -1.0, 1.0));
    if (away <= reach) return dir;
    const Vec3 across = (dir - dir.dot(start) * start).normalized();
    return std::cos(reach) * start + std::sin(reach) * across;
  }

  const std::vector<double>& reach_;
  std::vector<DirectionalLight>& lights_;
  double mean_;
  Coefficients wanted_ = Coefficients::Zero();
  std::vector<Vec3> start_;
};

}  // namespace

void match_irradiance(const LightCells& cells, const std::vector<double>& reach,
                      std::vector<DirectionalLight>& lights) {
  HDR_ASSERT(reach.size() == lights.size());
  if (lights.size() > 1 && !cells.black) Matcher(cells, reach, lights).run();
}

}  // namespace hdr
