// Turning, windowing, choosing a degree, and the texts for other programs.
#include <gtest/gtest.h>

#include "libhdr/light/cube.h"
#include "libhdr/light/sh_text.h"
#include "libhdr/light/sh_window.h"
#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

using test::lobes_map;
using test::random_dir;

Mat3 random_rotation(Random& random) {
  return Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
      .normalized()
      .toRotationMatrix();
}

Sh random_sh(int degree, Random& random) {
  Sh sh{degree, {}};
  for (int k = 0; k < (degree + 1) * (degree + 1); ++k)
    sh.coefficients.emplace_back(random.normal(), random.normal(), random.normal());
  return sh;
}

Sh of_map(View<const float> map, int degree) {
  return project(map, LatLong{map.size()}, degree);
}

TEST(ShRotation, TurnedLightIsTheLightFromTheTurnedDirection) {
  Random random(1, 1);
  for (const int degree : {0, 1, 2, 3, 4, 7, 12, kMaxShDegree}) {
    for (int trial = 0; trial < 5; ++trial) {
      const Mat3 r = random_rotation(random);
      const Sh sh = random_sh(degree, random), turned = rotated(sh, r);
      for (int k = 0; k < 20; ++k) {
        const Vec3 d = random_dir(random);
        EXPECT_LT((evaluate(turned, r * d) - evaluate(sh, d)).abs().maxCoeff(), 1e-9 * (degree + 1)) << degree;
      }
    }
  }
}

TEST(ShRotation, BandsKeepTheirEnergyAndTurningBackUndoesIt) {
  Random random(2, 1);
  const Sh sh = random_sh(9, random);
  const Mat3 r = random_rotation(random);
  const Sh turned = rotated(sh, r), back = rotated(turned, r.transpose());
  for (int l = 0; l <= sh.degree; ++l) {
    Rgb before = Rgb::Zero(), after = Rgb::Zero();
    for (int m = -l; m <= l; ++m) {
      before += sh(l, m).square();
      after += turned(l, m).square();
      EXPECT_LT((back(l, m) - sh(l, m)).abs().maxCoeff(), 1e-11);
    }
    EXPECT_LT((after - before).abs().maxCoeff(), 1e-11 * before.maxCoeff());
  }
}

TEST(ShRotation, AQuarterTurnAboutYMovesColumns) {
  // d_out = Ry(90) d_in takes +Z to +X, which is a quarter of the map to the left.
  const Image<float> map = lobes_map({64, 32}, 5, 30, 6);
  Image<float> moved(64, 32, 3);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) moved((x + 48) % 64, y, c) = map(x, y, c);
  const Sh turned = rotated(of_map(map, 6), rotation_from_degrees({0, 90, 0})), expected = of_map(moved, 6);
  for (std::size_t k = 0; k < expected.coefficients.size(); ++k) {
    EXPECT_LT((turned.coefficients[k] - expected.coefficients[k]).abs().maxCoeff(), 1e-12) << k;
  }
}

TEST(ShWindow, FactorsAreTheFormulas) {
  Random random(3, 1);
  const Sh sh = random_sh(2, random);
  const std::vector<double> hann = windowed(sh, ShWindow::kHann).factors;
  EXPECT_NEAR(hann[1], 0.75, 1e-15);  // (1 + cos 60) / 2
  EXPECT_NEAR(hann[2], 0.25, 1e-15);
  const std::vector<double> lanczos = windowed(sh, ShWindow::kLanczos).factors;
  EXPECT_NEAR(lanczos[1], std::sin(kPi / 3) / (kPi / 3), 1e-15);
  for (const ShWindow w : {ShWindow::kNone, ShWindow::kHann, ShWindow::kLanczos, ShWindow::kAuto}) {
    const WindowedSh result = windowed(sh, w);
    EXPECT_EQ(result.factors[0], 1) << "the mean is never changed";
    EXPECT_TRUE((result.sh(0, 0) == sh(0, 0)).all());
    for (std::size_t l = 0; l < 3; ++l) {
      const int k = static_cast<int>(l * l);
      EXPECT_NEAR(result.sh.coefficients[static_cast<std::size_t>(k)][0],
                  result.factors[l] * sh.coefficients[static_cast<std::size_t>(k)][0], 1e-15);
    }
  }
}

TEST(ShWindow, AutoLeavesNoNegativeIrradianceAndTouchesNothingThatDoesNotRing) {
  Random random(4, 1);
  int rang = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    // A sun of some pixels over a dim sky; every third map has no sun.
    Image<float> map = lobes_map({64, 32}, 2, 4, seed);
    if (seed % 3 != 0) {
      const int x = static_cast<int>(random.uniform() * 64), y = static_cast<int>(random.uniform() * 32);
      for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(1e3 * std::exp(5 * random.uniform()));
    }
    const Sh sh = of_map(map, 2 + static_cast<int>(seed % 4));
    const WindowedSh clean = windowed(sh, ShWindow::kAuto);
    double least = 1e30, largest = 0, least_before = 1e30;
    for (int k = 0; k < 4000; ++k) {
      const Vec3 n = random_dir(random);
      least = std::min(least, irradiance(clean.sh, n).minCoeff());
      largest = std::max(largest, irradiance(clean.sh, n).maxCoeff());
      least_before = std::min(least_before, irradiance(sh, n).minCoeff());
    }
    EXPECT_GE(least, -1e-6 * largest) << "seed " << seed;
    if (least_before < 0) {
      ++rang;
      // No more than is needed: the least irradiance is close to zero, not far above.
      EXPECT_LT(least, 0.02 * largest) << "seed " << seed;
      EXPECT_LT(clean.factors[1], 1);
    } else if (least_before > 0.01 * largest) {
      EXPECT_EQ(clean.factors.back(), 1) << "seed " << seed << ": nothing rings";
    }
  }
  EXPECT_GT(rang, 5) << "the maps of this test should ring";
}

TEST(ShWindow, TheBoundCountsWhatTheWindowTookAway) {
  const Image<float> map = lobes_map({48, 24}, 3, 300, 8);
  const Sh sh = of_map(map, 2);
  for (const ShWindow w : {ShWindow::kHann, ShWindow::kLanczos}) {
    const Sh softer = windowed(sh, w).sh;
    Random random(9, 0);
    double error = 0, largest = 0;
    for (int k = 0; k < 100; ++k) {
      const Vec3 n = random_dir(random);
      const Rgb e = irradiance(softer, n);
      error = std::max(error, (test::brute_force_irradiance(map, n, 2) - e).abs()[1]);
      largest = std::max(largest, e[1]);
    }
    EXPECT_GE(irradiance_error_bound(map, LatLong{map.size()}, softer), error / largest);
  }
}

TEST(ShDegree, IsTheLowestWithinTheError) {
  Image<float> grey = test::constant_map({32, 16}, Rgbf::Constant(2));
  EXPECT_EQ(project_within(grey, LatLong{grey.size()}, 0.01).sh.degree, 0);
  const Image<float> slope = test::latlong_map({128, 64}, [](const Vec3& d) { return 1.5 + d.x() - 0.3 * d.z(); });
  EXPECT_EQ(project_within(slope, LatLong{slope.size()}, 0.01).sh.degree, 1);
  const Image<float> black = test::constant_map({8, 4}, Rgbf::Zero());
  EXPECT_EQ(project_within(black, LatLong{black.size()}, 0.01).sh.degree, 0);
  Image<float> sun = grey.clone();
  for (int c = 0; c < 3; ++c) sun(9, 4, c) = 3e3f;
  int before = 0;
  for (const double error : {0.2, 0.08, 0.03}) {
    const ChosenSh chosen = project_within(sun, LatLong{sun.size()}, error);
    ASSERT_TRUE(chosen.met) << error;
    EXPECT_LE(chosen.bound, error);
    EXPECT_GE(chosen.sh.degree, before);
    before = chosen.sh.degree;
    if (chosen.sh.degree == 0) continue;
    const int lower = chosen.sh.degree > 2 ? chosen.sh.degree - 2 : chosen.sh.degree - 1;
    EXPECT_GT(irradiance_error_bound(sun, LatLong{sun.size()}, of_map(sun, lower)), error) << "not the lowest";
  }
  EXPECT_GE(before, 2);
  EXPECT_FALSE(project_within(sun, LatLong{sun.size()}, 1e-5).met);
}

TEST(ShText, PolynomialIsIrradianceOverPi) {
  Random random(5, 1);
  const Sh sh = random_sh(2, random);
  const std::array<Rgb, 9> c = irradiance_polynomial(sh);
  for (int k = 0; k < 50; ++k) {
    const Vec3 n = random_dir(random);
    const double x = n.x(), y = n.y(), z = n.z();
    const double terms[] = {1, y, z, x, x * y, y * z, 3 * z * z - 1, z * x, x * x - y * y};
    Rgb sum = Rgb::Zero();
    for (std::size_t i = 0; i < 9; ++i) sum += c[i] * terms[i];
    EXPECT_LT((kPi * sum - irradiance(sh, n)).abs().maxCoeff(), 1e-12);
  }
}

TEST(ShText, ThreeJsHas27NumbersInOurOrder) {
  Random random(6, 1);
  const Sh sh = random_sh(1, random);
  std::istringstream text(text_of(sh, ShFormat::kThreeJs));
  std::vector<double> numbers;
  char sign = 0;
  double number = 0;
  text >> sign;
  ASSERT_EQ(sign, '[');
  while (text >> number) {
    numbers.push_back(number);
    text >> sign;
  }
  ASSERT_EQ(numbers.size(), 27u);
  for (std::size_t k = 0; k < 27; ++k) {
    const double expected = k < 12 ? sh.coefficients[k / 3][static_cast<int>(k % 3)] : 0;
    EXPECT_NEAR(numbers[k], expected, 1e-8);
  }
}

TEST(Cube, FacesLookAlongTheirAxesAndMeetAtTheirEdges) {
  const Vec3 axes[] = {Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitY(), Vec3::UnitZ(), -Vec3::UnitZ()};
  for (int face = 0; face < 6; ++face) EXPECT_LT((dir_from_cube_face(face, 0.5, 0.5) - axes[face]).norm(), 1e-15);
  // OpenGL 4.6, table 8.19: on +X, s runs along -Z and t along -Y.
  EXPECT_LT(dir_from_cube_face(0, 0.9, 0.5).z(), 0);
  EXPECT_LT(dir_from_cube_face(0, 0.5, 0.9).y(), 0);
  EXPECT_GT(dir_from_cube_face(2, 0.5, 0.9).z(), 0);
  EXPECT_LT(dir_from_cube_face(5, 0.9, 0.5).x(), 0);
  EXPECT_LT((dir_from_cube_face(0, 0, 0.3) - dir_from_cube_face(4, 1, 0.3)).norm(), 1e-15) << "+X meets +Z";
  EXPECT_LT((dir_from_cube_face(2, 0.3, 1) - dir_from_cube_face(4, 0.3, 0)).norm(), 1e-15) << "+Y meets +Z";
}

}  // namespace
}  // namespace hdr
