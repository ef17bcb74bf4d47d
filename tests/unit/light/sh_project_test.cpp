// Projection: exact for constant pixels, whatever the map's size and projection.
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/parallel.h"
#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

using test::constant_map;
using test::latlong_map;

// L00 of a constant is L sqrt(4 pi), everything else nothing.
void expect_constant(const Sh& sh, const Rgb& radiance, double tolerance, const std::string& what) {
  const Rgb l00 = sh(0, 0);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(l00[c] / (radiance[c] * std::sqrt(4 * kPi)), 1, tolerance) << what << ": L00 of channel " << c;
  }
  for (int l = 1; l <= sh.degree; ++l)
    for (int m = -l; m <= l; ++m)
      EXPECT_LT((sh(l, m) / l00).abs().maxCoeff(), tolerance) << what << ": l " << l << " m " << m;
}

TEST(ShProject, ConstantLatLongOfAnySizeHasOnlyL00) {
  const Rgbf radiance(2.0f, 0.5f, 3e4f);
  for (const Size size : {Size{1, 1}, Size{2, 1}, Size{4, 2}, Size{7, 3}, Size{1, 5}, Size{64, 32}, Size{200, 30}}) {
    const Sh sh = project(constant_map(size, radiance), LatLong{size}, 8);
    expect_constant(sh, radiance.cast<double>(), 1e-12, std::to_string(size.width) + "x" + std::to_string(size.height));
  }
  const Size size{4, 2};
  expect_constant(project(constant_map(size, radiance), LatLong{size}, kMaxShDegree), radiance.cast<double>(), 1e-12,
                  "the highest degree");
}

TEST(ShProject, ConstantDiscMapsHaveOnlyL00) {
  const Rgbf radiance(1.0f, 0.25f, 7.0f);
  for (const int width : {16, 17, 40, 128, 300}) {
    const Image<float> map = constant_map({width, width}, radiance);
    const std::string size = std::to_string(width);
    expect_constant(project(map, AngularMap{inscribed_disc(width)}, 2), radiance.cast<double>(), 1e-5,
                    "angular " + size);
    expect_constant(project(map, MirrorBall{inscribed_disc(width)}, 2), radiance.cast<double>(), 1e-5, "ball " + size);
  }
}

TEST(ShProject, BallNearTheCameraHidesItsCone) {
  // Behind a ball at D radii a cone of half-angle asin(1/D) is not seen: the rest has 4 pi - 2 pi (1 - cos).
  constexpr int kWidth = 64;
  for (const double distance : {2.0, 5.0, 50.0}) {
    const Sh sh =
        project(constant_map({kWidth, kWidth}, Rgbf::Ones()), MirrorBall{inscribed_disc(kWidth), distance}, 2);
    const double cosine = std::sqrt(1 - 1 / (distance * distance));
    const double seen = 4 * kPi - 2 * kPi * (1 - cosine);
    EXPECT_NEAR(sh(0, 0)[0] * std::sqrt(4 * kPi), seen, 1e-4 * seen) << "at " << distance << " radii";
    // L10 of what is seen, the polar angles from 0 to pi - asin(1/D).
    const double l10 = std::sqrt(3 / (4 * kPi)) * kPi * (1 - cosine * cosine);
    EXPECT_NEAR(sh(1, 0)[0], l10, 1e-3) << "at " << distance << " radii";
  }
}

TEST(ShProject, PinholeViewCoversItsSolidAngle) {
  // A frustum with half-tangents a, b covers 4 atan(a b / sqrt(1 + a^2 + b^2)).
  const Size size{30, 20};
  const Sh sh = project(constant_map(size, Rgbf::Ones()), Rectilinear{size, 100}, 2);
  const double a = std::tan(50 * kDegree), b = a * 20 / 30;
  EXPECT_NEAR(sh(0, 0)[0] * std::sqrt(4 * kPi), 4 * std::atan(a * b / std::sqrt(1 + a * a + b * b)), 1e-9);
}

TEST(ShProject, BasisFunctionGivesADelta) {
  // Y_lm + 1 (to stay positive) sampled at pixel centres: L_lm = 1 but for the discretisation of order 1/width^2.
  const Size size{256, 128};
  constexpr int kDegree = 4;
  for (int k = 1; k < (kDegree + 1) * (kDegree + 1); ++k) {
    const Image<float> map = latlong_map(size, [&](const Vec3& d) {
      double y[25];
      sh_basis(d, kDegree, y);
      return 1 + y[k];
    });
    const Sh sh = project(map, LatLong{size}, kDegree);
    for (int j = 1; j < 25; ++j) {
      EXPECT_NEAR(sh.coefficients[static_cast<std::size_t>(j)][0], j == k ? 1 : 0, 2e-3) << "Y_" << k << " on " << j;
    }
  }
}

TEST(ShProject, OneBrightPixelIsTheBasisOverItsCell) {
  // The truth by splitting the pixel finely: the turn from the map's frame to the world's is right for each m.
  const Size size{8, 4};
  constexpr int kDegree = 6, kSplit = 200;
  for (const auto& [px, py] : {std::pair{0, 0}, {3, 1}, {6, 2}, {7, 3}}) {
    Image<float> map(size, 3);
    map(px, py, 1) = 1;
    const Sh sh = project(map, LatLong{size}, kDegree);
    std::vector<double> expected(49), y(49);
    for (int j = 0; j < kSplit; ++j) {
      for (int i = 0; i < kSplit; ++i) {
        sh_basis(dir_from_latlong((px + (i + 0.5) / kSplit) / size.width, (py + (j + 0.5) / kSplit) / size.height),
                 kDegree, y.data());
        const double w = latlong_pixel_solid_angle(py * kSplit + j, size.width * kSplit, size.height * kSplit);
        for (std::size_t k = 0; k < y.size(); ++k) expected[k] += w * y[k];
      }
    }
    for (std::size_t k = 0; k < y.size(); ++k) {
      EXPECT_NEAR(sh.coefficients[k][1], expected[k], 2e-5) << "pixel " << px << "," << py << " function " << k;
      EXPECT_EQ(sh.coefficients[k][0], 0);
    }
  }
}

TEST(ShProject, ProjectionsOfOneWorldAgree) {
  // A smooth world sampled in three projections.
  const auto world = [](const Vec3& d) { return 1.5 + d.x() - 0.5 * d.y() * d.z() + 0.3 * d.z(); };
  const Size size{512, 256};
  const Sh reference = project(latlong_map(size, world), LatLong{size}, 3);
  constexpr int kWidth = 300;
  for (const Projection& projection :
       {Projection(AngularMap{inscribed_disc(kWidth)}), Projection(MirrorBall{inscribed_disc(kWidth)})}) {
    Image<float> map(kWidth, kWidth, 3);
    for (int y = 0; y < kWidth; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (const auto d = dir_from_px(projection, {x + 0.5, y + 0.5})) {
          for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(world(*d));
        }
      }
    }
    const Sh sh = project(map, projection, 3);
    for (std::size_t k = 0; k < sh.coefficients.size(); ++k) {
      EXPECT_NEAR(sh.coefficients[k][0], reference.coefficients[k][0], 0.01 * reference(0, 0)[0])
          << text_from_projection(projection) << " function " << k;
    }
  }
}

TEST(ShProject, SameBitsForAnyNumberOfThreads) {
  const Image<float> map = test::lobes_map({100, 50}, 5, 100, 3);
  set_threads(1);
  const Sh one = project(map, LatLong{map.size()}, 5);
  set_threads(2);
  const Sh two = project(map, LatLong{map.size()}, 5);
  set_threads(0);
  for (std::size_t k = 0; k < one.coefficients.size(); ++k) {
    EXPECT_TRUE((one.coefficients[k] == two.coefficients[k]).all()) << "function " << k;
  }
}

}  // namespace
}  // namespace hdr
