// Where digits are lost: problems made worse and worse, with their condition numbers, against long double. The error is
// in units of a double's rounding, 1.1e-16: as many of them as the condition number says must be expected, whatever
// the program; more are the program's own. What the obvious way or float would leave stands beside it.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/environment.h"
#include "libhdr/light/internal/row_moments.h"
#include "libhdr/light/sh.h"
#include "libhdr/response/internal/debevec_malik.h"
#include "libhdr/response/internal/normal_equations.h"
#include "tests/bench/stopwatch.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/suite.h"

namespace hdr::bench {
namespace {

using Long = long double;
constexpr Long kPiLong = std::numbers::pi_v<Long>;
constexpr double kRounding = 0x1p-53;

struct Measured {
  std::string stage, subject, knob;
  double value = 0;
  Long answer = 0, truth = 0;
};

/// `work` gives the answer of `row`, its error relative to the truth.
void add(Bench& bench, Measured measured, const std::function<Long()>& work) {
  Row row{"numerics", measured.stage, measured.subject, measured.knob};
  row.value = measured.value;
  row.threads = 1;
  row.error_name = "relative, in units of 1.1e-16 (2^-53)";
  row.error_unit = "roundings";
  const Stopwatch watch;
  measured.answer = work();
  const Seconds spent = watch.elapsed();
  row.error = static_cast<double>(std::abs(measured.answer / measured.truth - 1)) / kRounding;
  row.cpu_seconds = row.median_cpu_seconds = spent.cpu;
  row.wall_seconds = spent.wall;
  bench.add(row);
}

/// Small waves along a row on a pedestal that grows: what a moment keeps of them.
void moments(Bench& bench) {
  constexpr int kWidth = 1000, kWave = 3;
  const AzimuthTable table(kWidth, kWave);
  for (const float pedestal : {0.0f, 1e2f, 1e4f, 1e6f}) {
    Image<float> rows(kWidth, 1, 3);
    Random random(3, 1);
    Long truth = 0, size = 0;
    const Long cell = 2 * kPiLong / kWidth;
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) rows(x, 0, c) = pedestal + 0.125f * static_cast<float>(1 + random.bits() % 8);
      const Long high = kPiLong - cell * x, low = kPiLong - cell * (x + 1);
      const Long term = (std::sin(kWave * high) - std::sin(kWave * low)) / kWave * rows(x, 0, 1);
      truth += term;
      size += std::abs(term);
    }
    const double condition = static_cast<double>(size / std::abs(truth));
    const std::string stage = "moments of a row: waves on a pedestal";
    add(bench, {stage, "hdr", "condition number", condition, 0, truth}, [&]() -> Long {
      std::vector<double> moments(static_cast<std::size_t>(3 * table.count()));
      row_moments(rows, table, moments.data());
      return moments[(2 * kWave - 1) * 3 + 1];
    });
    add(bench, {stage, "sums in float", "condition number", condition, 0, truth}, [&]() -> Long {
      const Eigen::MatrixXf azimuth = table.whole().cast<float>();
      float sum = 0;
      for (int x = 0; x < kWidth; ++x) sum += azimuth(x, 2 * kWave - 1) * rows(x, 0, 1);
      return sum;
    });
  }
}

/// Y_11 of a map that is nearly one value: the sum over pixels of what cancels.
void harmonics(Bench& bench) {
  const Size size{128, 64};
  for (const float pedestal : {0.0f, 1e2f, 1e4f, 1e6f}) {
    Image<float> map(size, 3);
    Random random(4, 1);
    Long truth = 0, total = 0;
    for (int y = 0; y < size.height; ++y) {
      // Y_11 = sqrt(3 / 4 pi) x; its integral over a cell is that of sin^2 theta times that of sin phi.
      const Long top = kPiLong * y / size.height, bottom = kPiLong * (y + 1) / size.height;
      const Long polar = (bottom - top) / 2 - std::cos(bottom + top) * std::sin(bottom - top) / 2;
      for (int x = 0; x < size.width; ++x) {
        for (int c = 0; c < 3; ++c) map(x, y, c) = pedestal + 0.125f * static_cast<float>(1 + random.bits() % 8);
        const Long high = kPiLong * (1 - 2.0L * x / size.width), low = kPiLong * (1 - 2.0L * (x + 1) / size.width);
        const Long term = std::sqrt(3 / (4 * kPiLong)) * polar * (std::cos(low) - std::cos(high)) * map(x, y, 0);
        truth += term;
        total += std::abs(term);
      }
    }
    const double condition = static_cast<double>(total / std::abs(truth));
    const std::string stage = "harmonics: waves on a pedestal";
    add(bench, {stage, "hdr", "condition number", condition, 0, truth},
        [&]() -> Long { return project(map, LatLong{size}, 2)(1, 1)[0]; });
    add(bench, {stage, "sums in float, a pixel a direction", "condition number", condition, 0, truth}, [&]() -> Long {
      float sum = 0;
      for (int y = 0; y < size.height; ++y) {
        const auto solid_angle = static_cast<float>(latlong_pixel_solid_angle(y, size.width, size.height));
        for (int x = 0; x < size.width; ++x) {
          const Vec3 d = dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height);
          sum += solid_angle * std::sqrt(static_cast<float>(0.75 / kPi)) * static_cast<float>(d.x()) * map(x, y, 0);
        }
      }
      return sum;
    });
  }
}

/// The pixel beside a pole, of maps that grow: cos a - cos b cancels, and a product of sines does not.
void solid_angles(Bench& bench) {
  for (const int height : {8, 64, 512, 4096, 32768}) {
    const Long step = kPiLong / height, s = std::sin(step / 2);
    const Long truth = kPiLong / height * 2 * s * s;
    const double condition = static_cast<double>((1 + std::cos(step)) / (2 * s * s));
    const std::string stage = "the solid angle of a pixel beside a pole";
    add(bench, {stage, "hdr", "condition number", condition, 0, truth},
        [&]() -> Long { return latlong_pixel_solid_angle(0, 2 * height, height); });
    add(bench, {stage, "cos a - cos b", "condition number", condition, 0, truth},
        [&]() -> Long { return 2 * kPi / (2 * height) * (std::cos(0.0) - std::cos(kPi / height)); });
  }
}

/// Eight-bit points of a curve in the exposures of a bracket.
Eigen::MatrixXd points_of(const Response& response, const Eigen::VectorXd& ln_exposure, int count) {
  Eigen::MatrixXd codes(count, ln_exposure.size());
  Random random(5, 1);
  const std::vector<double> thresholds = response.exposure_thresholds(1);
  for (int i = 0; i < count; ++i) {
    const double light = std::exp(12 * random.uniform() - 8);
    for (Eigen::Index j = 0; j < ln_exposure.size(); ++j) {
      const double exposure = light * std::exp(ln_exposure[j]);
      const auto code = std::upper_bound(thresholds.begin(), thresholds.end(), exposure) - thresholds.begin();
      codes(i, j) = code < 3 || code > 252 ? std::nan("") : static_cast<double>(code);
    }
  }
  return codes;
}

/// The same equations, made and solved in long double: their condition, and g at code 200.
struct LongFit {
  Long condition = 0, g = 0;
};
LongFit fitted(const Knots& knots, const Eigen::MatrixXd& codes, const Eigen::VectorXd& ln_exposure,
               double smoothness) {
  using Matrix = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<Long, Eigen::Dynamic, 1>;
  const CodeWeights weights = CodeWeights::hat(8);
  const int n = knots.count();
  Matrix matrix = Matrix::Zero(n, n);
  Vector right = Vector::Zero(n);
  for (Eigen::Index i = 0; i < codes.rows(); ++i) {
    Vector mean = Vector::Zero(n);
    Long total = 0, sum = 0;
    for (Eigen::Index j = 0; j < codes.cols(); ++j) {
      if (std::isnan(codes(i, j))) continue;
      const auto k = static_cast<Eigen::Index>(codes(i, j));  // 8 bits: a knot at every code
      const Long square = std::pow(static_cast<Long>(weights.at(codes(i, j))), 2);
      matrix(k, k) += square;
      right[k] += square * ln_exposure[j];
      mean[k] += square;
      total += square;
      sum += square * ln_exposure[j];
    }
    if (!(total > 0)) continue;
    matrix -= mean * mean.transpose() / total;
    right -= mean * sum / total;
  }
  for (int k = 1; k + 1 < n; ++k) {
    const std::array<double, 3> c = smoothness_coefficients(knots, k, smoothness);
    for (int p = 0; p < 3; ++p) {
      for (int q = 0; q < 3; ++q) {
        matrix(k - 1 + p, k - 1 + q) +=
            static_cast<Long>(c[static_cast<std::size_t>(p)]) * c[static_cast<std::size_t>(q)];
      }
    }
  }
  const int middle = knots.middle();
  matrix.row(middle).setZero();
  matrix.col(middle).setZero();
  matrix(middle, middle) = 1;
  right[middle] = 0;
  const auto lengths = Eigen::SelfAdjointEigenSolver<Matrix>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
  const Vector g = matrix.ldlt().solve(right);
  return {lengths[n - 1] / lengths[0], g[200]};
}

/// [Debevec97] eq. 3: the less smoothness, the less the codes that few points have are tied to the others.
void responses(Bench& bench) {
  const Knots knots(8);
  Eigen::VectorXd ln_exposure(7);
  for (Eigen::Index j = 0; j < 7; ++j) ln_exposure[j] = 1.3 * static_cast<double>(j - 3);
  const Eigen::MatrixXd codes = points_of(film_response(8), ln_exposure, 100);
  for (const double smoothness : {1e2, 1.0, 1e-2, 1e-4, 1e-6}) {
    const LongFit truth = fitted(knots, codes, ln_exposure, smoothness);
    add(bench,
        {"[Debevec97] eq. 3: g(200) as the smoothness falls", "hdr", "condition number",
         static_cast<double>(truth.condition), 0, truth.g},
        [&]() -> Long {
          return NormalEquations(knots, CodeWeights::hat(8), codes, ln_exposure).solve(smoothness)[200];
        });
  }
}

/// Fully normalised P_lm by the same recurrence in long double.
Long zonal(int degree, Long z) {
  Long before = 0, value = std::sqrt(1 / (4 * kPiLong));
  for (int l = 0; l < degree; ++l) {
    const Long next = l + 1, a = std::sqrt((4 * next * next - 1) / (next * next));
    const Long b = l > 0 ? std::sqrt(Long{1} * l * l / (4 * Long{1} * l * l - 1)) : 0;
    const Long after = a * (z * value - b * before);
    before = value;
    value = after;
  }
  return value;
}

/// The error of recurrences as the degree grows, near a pole, where the functions are steep.
void recurrences(Bench& bench) {
  for (const int degree : {1, 2, 4, 8, 16, 32}) {
    const double z = std::cos(0.01);
    std::vector<double> y(static_cast<std::size_t>((degree + 1) * (degree + 1)));
    add(bench, {"the basis near a pole, by degree", "hdr", "degree", static_cast<double>(degree), 0, zonal(degree, z)},
        [&]() -> Long {
          sh_basis(Vec3(std::sqrt(1 - z * z), 0, z), degree, y.data());
          return y[static_cast<std::size_t>(degree * (degree + 1))];
        });
  }
}

/// The error of a sum as the number of its terms grows.
void totals(Bench& bench) {
  for (const int width :
       bench.quick() ? std::vector<int>{16, 64, 256, 1024} : std::vector<int>{16, 64, 256, 1024, 4096}) {
    const Image<float> map = light_map(bench, width);
    Long truth = 0;
    for (int y = 0; y < map.height(); ++y) {
      const Long top = kPiLong * y / map.height(), bottom = kPiLong * (y + 1) / map.height();
      const Long solid_angle = 4 * kPiLong / width * std::sin((top + bottom) / 2) * std::sin((bottom - top) / 2);
      for (int x = 0; x < width; ++x) truth += solid_angle * map(x, y, 1);
    }
    const double pixels = 0.5 * width * width;
    add(bench, {"the light of a map, by pixels", "hdr", "pixels", pixels, 0, truth},
        [&]() -> Long { return Environment(map.clone()).total_power()[1]; });
    add(bench, {"the light of a map, by pixels", "a running sum in float", "pixels", pixels, 0, truth}, [&]() -> Long {
      float sum = 0;
      for (int y = 0; y < map.height(); ++y) {
        const auto solid_angle = static_cast<float>(latlong_pixel_solid_angle(y, width, map.height()));
        for (int x = 0; x < width; ++x) sum += solid_angle * map(x, y, 1);
      }
      return sum;
    });
  }
}

}  // namespace

void numerics_suite(Bench& bench) {
  const auto part = [&](const char* stage, void (*work)(Bench&)) {
    bench.attempt("numerics", stage, [&] { work(bench); });
  };
  part("moments", moments);
  part("harmonics", harmonics);
  part("solid angles", solid_angles);
  part("responses", responses);
  part("recurrences", recurrences);
  part("totals", totals);
}

}  // namespace hdr::bench
