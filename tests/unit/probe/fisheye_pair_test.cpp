#include "libhdr/probe/fisheye_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

/// Something to recognise everywhere: many waves down to two degrees long.
class Carpet {
 public:
  explicit Carpet(std::uint64_t seed) {
    Random random(seed, 21);
    for (int n = 0; n < 40; ++n) {
      waves_.push_back({test::random_direction(random) * (20 + 160 * random.uniform()), 2 * kPi * random.uniform()});
    }
  }
  float operator()(const Vec3& d) const {
    double sum = 0;
    for (const auto& [k, phase] : waves_) sum += std::sin(k.dot(d) + phase);
    return static_cast<float>(std::exp(0.15 * sum));
  }

 private:
  std::vector<std::pair<Vec3, double>> waves_;
};

Image<float> photograph(const Carpet& world, const Fisheye& lens, const Mat3& probe_from_view, double gain, Size size) {
  Image<float> picture(size, 3);
  for_rows(size.height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const auto d = lens.dir_from_px({x + 0.5, y + 0.5});
        const float value = d ? static_cast<float>(gain) * world(probe_from_view * *d) : 0;
        for (int c = 0; c < 3; ++c) picture(x, y, c) = value * static_cast<float>(1 + 0.1 * c);
      }
    }
  });
  return picture;
}

double angle_degrees(const Mat3& a, const Mat3& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle() / kDegree;
}

TEST(FisheyePair, LensesRotationAndGainAreFound) {
  const Size size{840, 820};
  for (const std::uint64_t seed : {1u, 2u}) {
    Random random(seed, 4);
    const auto off = [&](double most) { return most * (2 * random.uniform() - 1); };
    const Carpet world(seed);
    const Lens kind = seed == 2 ? Lens::kEquisolid : Lens::kEquidistant;
    const Fisheye front{{420 + off(2), 410 + off(2), 400}, 196, kind},
        back{{418 + off(2), 412 + off(2), 402}, 196, kind};
    const Mat3 turn = rotation_from_degrees({off(2), 180 + off(2), off(2)});
    const double gain = std::exp2(off(1));
    const Image<float> a = photograph(world, front, Mat3::Identity(), 1, size);
    const Image<float> b = photograph(world, back, turn, gain, size);
    // The guess: circles in the middle, an ideal lens whose field is two degrees off, back to back.
    const Fisheye guess_a{{420, 410, 400}, 194, kind}, guess_b{{418, 412, 402}, 194, kind};
    const FisheyePair pair = solve_fisheye_pair(a, b, guess_a, guess_b);
    EXPECT_GT(pair.matches, 60);
    EXPECT_LT(pair.residual_degrees, 0.1) << "seed " << seed;
    EXPECT_LT(angle_degrees(pair.views[1].probe_from_view, turn), 0.25) << "seed " << seed;
    EXPECT_NEAR(pair.views[1].gain * gain, 1, 0.02) << "seed " << seed;
    EXPECT_LT(pair.overlap_rms, 0.1) << "seed " << seed;

    const Image<float> sphere = merge_fisheye_pair({a}, {b}, pair, 512).rgb;
    double worst = 0;
    std::vector<double> errors;
    for (int y = 8; y < 248; ++y) {
      for (int x = 0; x < 512; ++x) {
        const double truth = world(dir_from_latlong((x + 0.5) / 512, (y + 0.5) / 256));
        errors.push_back(std::abs(std::log2(std::max(1e-6f, sphere(x, y, 0)) / truth)));
        worst = std::max(worst, errors.back());
      }
    }
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.15) << "seed " << seed << ", worst " << worst;
  }
}

// A tripod's head turned by hand from one side to the other: farther off than features are first sought.
TEST(FisheyePair, ATurnThatIsTenDegreesOffIsFound) {
  const Fisheye lens{{420, 410, 400}, 198}, guess{{420, 410, 400}, 196};
  for (const std::uint64_t seed : {11u, 12u}) {
    const Carpet world(seed);
    const Mat3 turn = rotation_from_degrees({seed == 11 ? 7.0 : -5.0, seed == 11 ? 172.0 : 186.0, 6});
    const Image<float> a = photograph(world, lens, Mat3::Identity(), 1, {840, 820});
    const Image<float> b = photograph(world, lens, turn, 1, {840, 820});
    const FisheyePair pair = solve_fisheye_pair(a, b, guess, guess);
    EXPECT_LT(angle_degrees(pair.views[1].probe_from_view, turn), 0.25) << "seed " << seed;
    EXPECT_LT(pair.residual_degrees, 0.1) << "seed " << seed;
  }
}

TEST(FisheyePair, WhatDoesNotOverlapIsAnError) {
  const Carpet one(7), other(8);
  const Fisheye lens{{200, 200, 190}, 195};
  const Image<float> a = photograph(one, lens, Mat3::Identity(), 1, {400, 400});
  const Image<float> b = photograph(other, lens, rotation_from_degrees({0, 180, 0}), 1, {400, 400});
  try {
    solve_fisheye_pair(a, b, lens, lens);
    ADD_FAILURE() << "two worlds became one sphere";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("in common"), std::string::npos) << error.what();
  }
  const Fisheye narrow{{200, 200, 190}, 175};
  EXPECT_THROW(solve_fisheye_pair(a, b, narrow, narrow), Error);
}

}  // namespace
}  // namespace hdr
