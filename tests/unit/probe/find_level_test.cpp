#include "libhdr/probe/find_level.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/unwrap.h"
#include "tests/support/carpet.h"
#include "tests/support/rounds.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

/// What a camera makes of it: a mean over each pixel.
template <class World>
Image<float> picture_of(const World& world, const Mat3& turn) {
  constexpr int kWidth = 1024, kParts = 3;
  Image<float> map(kWidth, kWidth / 2, 3);
  for_rows(kWidth / 2, 8, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        double sum = 0;
        for (int part = 0; part < kParts * kParts; ++part) {
          const double u = (x + (part % kParts + 0.5) / kParts) / kWidth;
          const double v = (y + (part / kParts + 0.5) / kParts) / (0.5 * kWidth);
          sum += world(turn * dir_from_latlong(u, v), 1);
        }
        for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(sum / (kParts * kParts));
      }
    }
  });
  return map;
}

/// A street: house fronts of many heights and greys, with windows, under a sky, over a ground of patches.
class Street {
 public:
  explicit Street(std::uint64_t seed) : seed_(seed) {}
  double operator()(const Vec3& d, int) const {
    const double azimuth = std::atan2(d.x(), d.z()) / kDegree, up = std::asin(d.y()) / kDegree;
    const int house = static_cast<int>(std::floor((azimuth + 180) / 12.3));
    const double roof = 8 + 35 * noise(house, 1);
    if (up > roof) return 3 + 0.5 * std::sin(0.1 * azimuth) * std::cos(0.2 * up);
    if (up < -12) {
      const double scale = 1 / std::tan(-up * kDegree);
      const double x = scale * std::sin(azimuth * kDegree), z = scale * std::cos(azimuth * kDegree);
      return 0.3 + 0.4 * noise(static_cast<int>(std::floor(2.3 * x)), static_cast<int>(std::floor(2.1 * z)) + 100);
    }
    const double in_house = std::fmod(azimuth + 180, 12.3), tall = std::tan(up * kDegree);
    const bool window = std::fmod(in_house, 3.1) > 1.7 && std::fmod(tall + 1, 0.16) > 0.08;
    return (0.2 + noise(house, 2)) * (window ? 0.4 : 1);
  }

 private:
  double noise(int a, int b) const {
    Random random(seed_, static_cast<std::uint64_t>(a + 1000), static_cast<std::uint64_t>(b + 1000));
    return random.uniform();
  }
  std::uint64_t seed_;
};

double off_level(const Mat3& level_from_picture, const Mat3& world_from_picture) {
  // Both bring the picture's zenith to +Y when they agree.
  const Vec3 zenith = world_from_picture.transpose() * Vec3::UnitY();
  return std::acos(std::clamp((level_from_picture * zenith).y(), -1.0, 1.0)) / kDegree;
}

TEST(FindLevel, TiltsAreFound) {
  for (std::uint64_t seed = 1; seed < 1 + test::rounds(8); ++seed) {
    Random random(seed, 3);
    const auto off = [&](double most) { return most * (2 * random.uniform() - 1); };
    const Mat3 turn = rotation_from_degrees({off(20), off(180), off(20)});
    const Street street(seed);
    const Image<float> picture = picture_of(street, turn);
    const auto found = find_level(picture);
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_LT(off_level(found->level_from_picture, turn), 0.25) << "seed " << seed;
    const double tilt = std::acos((turn.transpose() * Vec3::UnitY()).y()) / kDegree;
    EXPECT_NEAR(found->tilt_degrees, tilt, 0.25);
  }
}

TEST(FindLevel, APartOfTheSphereWillDo) {
  const Street street(21);
  const Mat3 turn = rotation_from_degrees({7, 40, -5});
  const Image<float> picture = picture_of(street, turn);
  Image<float> shown(picture.size(), 1);
  for (int y = 128; y < 384; ++y) std::fill_n(shown.row(y) + 256, 512, 1.0f);
  const auto found = find_level(picture, shown);
  ASSERT_TRUE(found);
  EXPECT_LT(off_level(found->level_from_picture, turn), 0.6);
}

TEST(FindLevel, WithoutVerticalsThereIsNone) {
  for (std::uint64_t seed = 1; seed < 1 + test::rounds(3); ++seed) {
    const test::Carpet carpet(seed);
    const Image<float> waves = test::latlong_of(512, [&](const Vec3& d, int) { return carpet(d); });
    EXPECT_FALSE(find_level(waves)) << seed;
  }
  EXPECT_FALSE(find_level(test::latlong_of(256, [](const Vec3&, int) { return 1.0; }))) << "one grey";
}

TEST(FindLevel, PointsOfTheHorizonSayIt) {
  const Mat3 turn = rotation_from_degrees({9, 70, -14});
  std::vector<Vec3> points;
  for (const double azimuth : {0.0, 80.0, 200.0}) {
    points.push_back(turn.transpose() * Vec3(std::sin(azimuth * kDegree), 0, std::cos(azimuth * kDegree)));
  }
  EXPECT_LT(off_level(level_from_horizon(points), turn), 1e-6);
  EXPECT_LT(off_level(level_from_horizon({points[0], points[1]}), turn), 1e-6);
  EXPECT_THROW(level_from_horizon({points[0]}), Error);
  EXPECT_THROW(level_from_horizon({points[0], points[0]}), Error);
  EXPECT_THROW(level_from_horizon({Vec3::UnitY(), Vec3::UnitZ()}), Error);
}

}  // namespace
}  // namespace hdr
