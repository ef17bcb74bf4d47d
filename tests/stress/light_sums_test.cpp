// Sums over a probe against the same sums in long double: light of 1e12 beside 1e-12, and small waves on a pedestal of
// 1e6, whose harmonics are differences that lose seven digits. Bounds are shares of the sum of absolute values: double
// leaves 1e-13 of it, float would leave 1e-7.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libhdr/core/sphere.h"
#include "libhdr/light/environment.h"
#include "libhdr/light/horizontal_irradiance.h"
#include "libhdr/light/internal/light_cells.h"
#include "libhdr/light/internal/row_moments.h"
#include "libhdr/light/lights.h"
#include "libhdr/light/sh.h"
#include "tests/stress/hostile.h"

namespace hdr::stress {
namespace {

using Long = long double;
constexpr Long kPiLong = std::numbers::pi_v<Long>;

/// Of a row of a lat-long.
Long pixel_solid_angle(int y, Size size) {
  const Long top = kPiLong * y / size.height, bottom = kPiLong * (y + 1) / size.height;
  return 2 * kPiLong / size.width * 2 * std::sin((top + bottom) / 2) * std::sin((bottom - top) / 2);
}

/// Gauss and Legendre's nodes and weights on [0, 1], by Newton's method from Chebyshev's guesses.
struct Rule {
  std::vector<Long> nodes, weights;
  explicit Rule(int n) {
    for (int k = 0; k < n; ++k) {
      Long x = std::cos(kPiLong * (k + 0.75L) / (n + 0.5L)), slope = 1;
      for (int step = 0; step < 50; ++step) {
        Long before = 1, here = x;
        for (int l = 2; l <= n; ++l) {
          const Long after = ((2 * l - 1) * x * here - (l - 1) * before) / l;
          before = here;
          here = after;
        }
        slope = n * (x * here - before) / (x * x - 1);
        x -= here / slope;
      }
      nodes.push_back((1 - x) / 2);
      weights.push_back(1 / ((1 - x * x) * slope * slope));
    }
  }
};

struct LongSums {
  std::vector<Long> value[3], size[3];  ///< of the coefficients; size: of absolute values
};

/// Every pixel by quadrature over its cell: nothing of project() is shared but the basis.
LongSums projected(View<const float> map, int degree) {
  static const Rule rule(16);
  const auto count = static_cast<std::size_t>((degree + 1) * (degree + 1));
  LongSums sums;
  for (int c = 0; c < 3; ++c) sums.value[c].assign(count, 0), sums.size[c].assign(count, 0);
  std::vector<double> basis(count);
  const Long du = 2 * kPiLong / map.width(), dv = kPiLong / map.height();
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
          const Long polar = dv * (y + rule.nodes[j]), azimuth = kPiLong - du * (x + rule.nodes[i]);
          const Long weight = rule.weights[j] * rule.weights[i] * du * dv * std::sin(polar);
          const Vec3 d(static_cast<double>(std::sin(polar) * std::sin(azimuth)), static_cast<double>(std::cos(polar)),
                       static_cast<double>(std::sin(polar) * std::cos(azimuth)));
          sh_basis(d, degree, basis.data());
          for (std::size_t k = 0; k < count; ++k) {
            for (int c = 0; c < 3; ++c) {
              const Long term = weight * basis[k] * map(x, y, c);
              sums.value[c][k] += term;
              sums.size[c][k] += std::abs(term);
            }
          }
        }
      }
    }
  }
  return sums;
}

RC_GTEST_PROP(LightSums, HarmonicsAreThoseOfLongDouble, ()) {
  MapPlan plan = *any_latlong(16);
  const int degree = *rc::gen::inRange(0, 5);
  const Image<float> map = made(plan);
  const LongSums truth = projected(map, degree);
  const Sh sh = project(map, LatLong{map.size()}, degree);
  for (std::size_t k = 0; k < sh.coefficients.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      // A cell of 180 degrees (a map of one pixel) is what the rule of 16 nodes leaves 1e-13 of.
      const Long off = std::abs(sh.coefficients[k][c] - truth.value[c][k]);
      RC_ASSERT(off <= 2e-12L * truth.size[c][k] + 1e-300L);
    }
  }
}

// The fast sums along rows, whatever the width: eighths, quarters, vectors and what is left over at the end.
RC_GTEST_PROP(LightSums, RowMomentsAreThoseOfLongDouble, ()) {
  const MapPlan plan = {*rc::gen::inRange(1, 200), 2,
                        *rc::gen::map(rc::gen::inRange(0, 8), [](int k) { return static_cast<Light>(k); }),
                        *rc::gen::inRange<std::uint64_t>(0, 10000)};
  const int degree = *rc::gen::inRange(0, 13);
  const Image<float> map = made(plan);
  const AzimuthTable table(map.width(), degree);
  std::vector<double> moments(static_cast<std::size_t>(2 * 3 * table.count()));
  row_moments(map, table, moments.data());
  const Long cell = 2 * kPiLong / map.width();
  for (int y = 0; y < 2; ++y) {
    for (int k = 0; k < table.count(); ++k) {
      const int m = (k + 1) / 2;
      Long sum[3] = {}, size[3] = {};
      for (int x = 0; x < map.width(); ++x) {
        const Long high = kPiLong - cell * x, low = kPiLong - cell * (x + 1);
        const Long weight = m == 0       ? cell
                            : k % 2 == 1 ? (std::sin(m * high) - std::sin(m * low)) / m
                                         : (std::cos(m * low) - std::cos(m * high)) / m;
        for (int c = 0; c < 3; ++c) sum[c] += weight * map(x, y, c), size[c] += cell * map(x, y, c);
      }
      for (int c = 0; c < 3; ++c) {
        const double moment = moments[static_cast<std::size_t>((y * table.count() + k) * 3 + c)];
        RC_ASSERT(std::abs(moment - sum[c]) <= 1e-13L * size[c] + 1e-300L);
      }
    }
  }
}

RC_GTEST_PROP(LightSums, PowerAndHorizontalIrradianceAreThoseOfLongDouble, ()) {
  const Image<float> map = made(*any_latlong(64));
  Long power[3] = {}, facing_up[3] = {};
  for (int y = 0; y < map.height(); ++y) {
    const Long top = kPiLong * y / map.height(), bottom = std::min(kPiLong * (y + 1) / map.height(), kPiLong / 2);
    const Long solid_angle = pixel_solid_angle(y, map.size());
    // The integral of cos sin over the part of the row above the horizon: (sin^2 b - sin^2 t) / 2 as a product.
    const Long cosine =
        bottom > top ? std::sin(bottom + top) * std::sin(bottom - top) / 2 * 2 * kPiLong / map.width() : 0;
    for (int x = 0; x < map.width(); ++x) {
      for (int c = 0; c < 3; ++c) power[c] += solid_angle * map(x, y, c), facing_up[c] += cosine * map(x, y, c);
    }
  }
  const Rgb irradiance = horizontal_irradiance(map);
  const Environment light(map.clone());
  for (int c = 0; c < 3; ++c) {
    RC_ASSERT(std::abs(irradiance[c] - facing_up[c]) <= 1e-13L * facing_up[c] + 1e-300L);
    RC_ASSERT(std::abs(light.total_power()[c] - power[c]) <= 1e-13L * power[c] + 1e-300L);
  }
}

// The cells that lights are cut from, of one pixel and of many: each sum is its own pixels'.
RC_GTEST_PROP(LightSums, CellsAreThoseOfLongDouble, ()) {
  const Image<float> map = made(*any_latlong(48));
  const LightCells cells = light_cells(map, *rc::gen::element(1, 2, 3, 16));
  const int block = (map.width() + cells.size.width - 1) / cells.size.width;
  for (int row = 0; row < cells.size.height; ++row) {
    for (int column = 0; column < cells.size.width; ++column) {
      const LightCell& cell = cells(column, row);
      Long light[3] = {}, moment[3] = {}, size = 0;
      for (int y = row * block; y < std::min((row + 1) * block, map.height()); ++y) {
        for (int x = column * block; x < std::min((column + 1) * block, map.width()); ++x) {
          const Long solid_angle = pixel_solid_angle(y, map.size());
          const Long value = solid_angle * (0.2126L * map(x, y, 0) + 0.7152L * map(x, y, 1) + 0.0722L * map(x, y, 2));
          const Vec3 d = dir_from_latlong((x + 0.5) / map.width(), (y + 0.5) / map.height());
          for (int c = 0; c < 3; ++c) light[c] += solid_angle * map(x, y, c), moment[c] += value * d[c];
          size += value;
        }
      }
      for (int c = 0; c < 3; ++c) {
        RC_ASSERT(std::abs(cell.light[c] - light[c]) <= 1e-13L * light[c] + 1e-300L);
        // Of a black map, cells weigh what their solid angles do.
        if (!cells.black) RC_ASSERT(std::abs(cell.moment[c] - moment[c]) <= 1e-13L * size + 1e-300L);
      }
    }
  }
}

// Lights carry all of the light, and their regions all of the sphere, whatever they are cut from.
RC_GTEST_PROP(LightSums, LightsLoseNothing, ()) {
  const Image<float> map = made(*any_latlong(48));
  LightsOptions options;
  options.count = *rc::gen::element(1, 2, 3, 7, 16, 64, 1000);
  options.method = static_cast<LightsMethod>(*rc::gen::inRange(0, 4));
  options.placement = static_cast<LightPlacement>(*rc::gen::inRange(0, 3));
  const Lights lights = make_lights(map, options);
  Long truth[3] = {}, sum[3] = {}, solid_angle = 0;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      for (int c = 0; c < 3; ++c) truth[c] += pixel_solid_angle(y, map.size()) * map(x, y, c);
    }
  }
  for (const DirectionalLight& light : lights.lights) {
    RC_ASSERT(light.irradiance.isFinite().all() && (light.irradiance >= 0).all());
    RC_ASSERT(std::abs(light.direction.norm() - 1) < 1e-6);
    for (int c = 0; c < 3; ++c) sum[c] += light.irradiance[c];
    solid_angle += light.solid_angle;
  }
  RC_ASSERT(!lights.lights.empty());
  RC_ASSERT(static_cast<int>(lights.lights.size()) <= options.count);
  for (int c = 0; c < 3; ++c) RC_ASSERT(std::abs(sum[c] - truth[c]) <= 1e-12L * truth[c] + 1e-300L);
  RC_ASSERT(std::abs(solid_angle - 4 * kPiLong) < 1e-10L);
}

// Turning and turning back, with bands that differ by 24 orders of magnitude: none leaks into another.
RC_GTEST_PROP(LightSums, RotationsKeepEachBandToItself, ()) {
  Sh sh{*rc::gen::element(1, 2, 5, 12, 32), {}};
  for (int l = 0; l <= sh.degree; ++l) {
    const double size = *power_of_ten(-12, 12);
    for (int m = -l; m <= l; ++m) {
      const Rgb digits(l * 0.1 + 0.3, std::sin(m), std::cos(l + m));
      sh.coefficients.emplace_back(size * digits);
    }
  }
  const Vec3 degrees(360 * *power_of_ten(-6, 0), 360 * *power_of_ten(-6, 0), 360 * *power_of_ten(-6, 0));
  const Mat3 turn = rotation_from_degrees(degrees);
  const Sh back = rotated(rotated(sh, turn), turn.transpose());
  for (int l = 0; l <= sh.degree; ++l) {
    Rgb norm = Rgb::Zero(), off = Rgb::Zero();
    for (int m = -l; m <= l; ++m) norm += sh(l, m).square(), off += (back(l, m) - sh(l, m)).square();
    RC_ASSERT((off.sqrt() <= 1e-11 * norm.sqrt()).all());
  }
}

}  // namespace
}  // namespace hdr::stress
