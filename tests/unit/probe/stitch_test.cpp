#include "libhdr/probe/stitch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "tests/support/carpet.h"
#include "tests/support/rounds.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

using test::Carpet;

struct Shot {
  Rectilinear lens;
  Mat3 world_from_view;
  double gain = 1;
  Image<float> picture;
};

/// A court with a column every thirty degrees, those of one end alike to those of the other.
class Court {
 public:
  explicit Court(std::uint64_t seed) : columns_(seed), between_(seed + 500) {}
  double operator()(const Vec3& d) const {
    const Vec3 at_one_end = d.z() < 0 ? Vec3(-d.x(), d.y(), -d.z()) : d;
    const double share = 0.5 + 0.5 * std::clamp(5 * std::cos(12 * std::atan2(d.x(), d.z())), -1.0, 1.0);
    return std::exp(share * std::log(columns_(at_one_end)) + (1 - share) * std::log(between_(d)));
  }

 private:
  Carpet columns_, between_;
};

template <class World>
void expose(const World& world, const Vignetting& vignetting, Shot& shot) {
  const Size size = shot.lens.size;
  shot.picture = Image<float>(size, 3);
  const Vec2 middle(0.5 * size.width, 0.5 * size.height);
  for_rows(size.height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const Vec2 px(x + 0.5, y + 0.5);
        const double passed = vignetting.at((px - middle).squaredNorm() / middle.squaredNorm());
        const double light = shot.gain * passed * world(shot.world_from_view * shot.lens.dir_from_px(px).value());
        for (int c = 0; c < 3; ++c) shot.picture(x, y, c) = static_cast<float>(light * (1 + 0.1 * c));
      }
    }
  });
}

struct Around {
  int count = 6;
  double fov = 80, tilt = 8;
  Size size{480, 360};
  BrownConrady distortion{};
  Vignetting vignetting{};
};

/// A ring of photographs with a hand's tilts, each with its own gain, in no order.
template <class World>
std::vector<Shot> photograph_around(const World& world, std::uint64_t seed, const Around& how) {
  Random random(seed, 5);
  const auto off = [&](double most) { return most * (2 * random.uniform() - 1); };
  std::vector<Shot> shots;
  for (int k = 0; k < how.count; ++k) {
    Shot shot{{how.size, how.fov, how.distortion}, {}, std::exp2(off(1)), {}};
    const double heading = 360.0 * ((k * 5) % how.count) / how.count + off(5);
    shot.world_from_view = rotation_from_degrees({0, heading, 0}) * rotation_from_degrees({off(how.tilt), 0, off(4)});
    expose(world, how.vignetting, shot);
    shots.push_back(std::move(shot));
  }
  return shots;
}

std::vector<StitchPhoto> photos_of(const std::vector<Shot>& shots) {
  std::vector<StitchPhoto> photos;
  for (const Shot& shot : shots) photos.push_back({shot.picture});
  return photos;
}

std::vector<std::string> names_of(std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < count; ++k) names.push_back("photo-" + std::to_string(k) + ".exr");
  return names;
}

Stitch solve(const std::vector<Shot>& shots, const StitchOptions& options = {}) {
  return solve_stitch(photos_of(shots), names_of(shots.size()), options);
}

double angle_degrees(const Mat3& a, const Mat3& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle() / kDegree;
}

double worst_rotation(const std::vector<Shot>& shots, const Stitch& stitch) {
  double worst = 0;
  for (std::size_t k = 0; k < shots.size(); ++k) {
    worst = std::max(worst, angle_degrees(shots[0].world_from_view.transpose() * shots[k].world_from_view,
                                          stitch.photos[k].probe_from_view));
  }
  return worst;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

TEST(Stitch, RotationsFocalLengthAndGainsAreFound) {
  for (const std::uint64_t seed : {1u, 3u}) {
    const Carpet world(seed);
    const std::vector<Shot> shots =
        photograph_around(world, seed, seed == 3 ? Around{8, 65, 8, {360, 480}} : Around{6, 85, 8});
    const Stitch stitch = solve(shots);
    EXPECT_LT(worst_rotation(shots, stitch), 0.1) << "seed " << seed;
    for (std::size_t k = 0; k < shots.size(); ++k) {
      ASSERT_TRUE(stitch.photos[k].used) << stitch.photos[k].skipped;
      EXPECT_NEAR(stitch.photos[k].lens.focal_px() / shots[k].lens.focal_px(), 1, 0.003) << "seed " << seed;
      EXPECT_NEAR(stitch.photos[k].gain * shots[k].gain / shots[0].gain, 1, 0.01) << "seed " << seed;
      EXPECT_LT(stitch.photos[k].residual_px, 0.5);
    }
    EXPECT_LT(stitch.overlap_rms, 0.08);

    const RadianceMap map = merge_stitch(photos_of(shots), stitch, 512);
    std::vector<double> errors;
    for (int y = 100; y < 156; ++y) {
      for (int x = 0; x < 512; ++x) {
        const Vec3 dir = dir_from_latlong((x + 0.5) / 512, (y + 0.5) / 256);
        const double truth = shots[0].gain * world(shots[0].world_from_view * dir);
        errors.push_back(std::abs(static_cast<double>(map.rgb(x, y, 0)) / truth - 1));
      }
    }
    EXPECT_LT(median(errors), 0.02) << "seed " << seed;
    ASSERT_FALSE(map.alpha.empty());
    EXPECT_EQ(map.alpha(256, 2), 0) << "nobody looked up";
    EXPECT_EQ(map.alpha(256, 128), 1);
  }
}

TEST(Stitch, DistortionIsFoundWhereThereIsSome) {
  const Carpet world(11);
  for (const double k1 : {-0.08, 0.0}) {
    const Around how{6, 85, 8, {480, 360}, {k1, 0, 0, 0, 0}};
    const std::vector<Shot> shots = photograph_around(world, 11, how);
    const Stitch stitch = solve(shots);
    EXPECT_TRUE(stitch.distorted || k1 == 0);
    EXPECT_NEAR(stitch.photos[0].lens.distortion.k1, k1, 0.015);
    EXPECT_LT(worst_rotation(shots, stitch), 0.1) << k1;
    EXPECT_NEAR(stitch.photos[0].lens.focal_px() / shots[0].lens.focal_px(), 1, 0.006) << k1;
  }
}

TEST(Stitch, VignettingIsFoundWhenItIsAskedFor) {
  const Carpet world(4);
  const Vignetting truth{-0.35, 0.08, 0};
  const Around how{6, 85, 8, {480, 360}, {}, truth};
  const std::vector<Shot> shots = photograph_around(world, 4, how);
  const Stitch stitch = solve(shots, {.vignetting = true});
  for (const double r2 : {0.2, 0.5, 0.9}) EXPECT_NEAR(stitch.vignetting.at(r2) / truth.at(r2), 1, 0.02) << r2;
  for (std::size_t k = 0; k < shots.size(); ++k) {
    EXPECT_NEAR(stitch.photos[k].gain * shots[k].gain / shots[0].gain, 1, 0.015);
  }
}

TEST(Stitch, AFieldThatIsKnownHelpsTwo) {
  const Carpet world(5);
  std::vector<Shot> shots = photograph_around(world, 5, {2, 70, 3});
  shots[1].world_from_view = shots[0].world_from_view * rotation_from_degrees({3, 45, 1});
  expose(world, {}, shots[1]);
  std::vector<StitchPhoto> photos = photos_of(shots);
  for (StitchPhoto& photo : photos) photo.fov_degrees = 71;
  const Stitch stitch = solve_stitch(photos, names_of(2));
  EXPECT_LT(worst_rotation(shots, stitch), 0.3);
  EXPECT_NEAR(stitch.photos[0].lens.fov_degrees, 70, 0.7);
}

TEST(Stitch, WhatDoesNotBelongIsLeftOutAndSaysWhy) {
  const Carpet world(6), elsewhere(66);
  std::vector<Shot> shots = photograph_around(world, 6, {5, 90, 8});
  const std::vector<Shot> other = photograph_around(elsewhere, 6, {1, 90, 8});
  const Image<float> blank = [] {
    Image<float> grey(480, 360, 3);
    for (int y = 0; y < 360; ++y) std::fill_n(grey.row(y), 1440, 0.5f);
    return grey;
  }();
  std::vector<StitchPhoto> photos = {{blank}, {other[0].picture}};
  for (const Shot& shot : shots) photos.push_back({shot.picture});
  photos.push_back({shots[1].picture});
  const Stitch stitch = solve_stitch(photos, names_of(photos.size()));
  EXPECT_NE(stitch.photos[0].skipped.find("nothing to recognise"), std::string::npos) << stitch.photos[0].skipped;
  EXPECT_NE(stitch.photos[1].skipped.find("nothing that the others show"), std::string::npos);
  EXPECT_NE(stitch.photos[7].skipped.find("the same photograph as photo-3.exr"), std::string::npos);
  for (std::size_t k = 0; k < 5; ++k) {
    ASSERT_TRUE(stitch.photos[k + 2].used);
    EXPECT_LT(angle_degrees(shots[0].world_from_view.transpose() * shots[k].world_from_view,
                            stitch.photos[k + 2].probe_from_view),
              0.1);
  }
}

// Features of columns say that the ends lie over each other; what stands between them says no. Some may be left out.
TEST(Stitch, OfTwoEndsThatLookAlikeNeitherIsLaidOverTheOther) {
  int used = 0, all = 0;
  for (std::uint64_t seed = 71; seed < 71 + test::rounds(4); ++seed) {
    const std::vector<Shot> shots = photograph_around(Court(seed), seed, {6, 76, 8});
    const Stitch stitch = solve(shots);
    std::size_t first = 0;
    while (!stitch.photos[first].used) ++first;
    for (std::size_t k = 0; k < shots.size(); ++k, ++all) {
      if (!stitch.photos[k].used) {
        EXPECT_FALSE(stitch.photos[k].skipped.empty()) << "seed " << seed << ", photograph " << k;
        continue;
      }
      ++used;
      const Mat3 truth = shots[first].world_from_view.transpose() * shots[k].world_from_view;
      const Mat3 found = stitch.photos[first].probe_from_view.transpose() * stitch.photos[k].probe_from_view;
      EXPECT_LT(angle_degrees(truth, found), 1) << "seed " << seed << ", photograph " << k;
    }
  }
  EXPECT_GE(used, all / 2);
}

void expect_error(const std::vector<StitchPhoto>& photos, const std::string& words) {
  try {
    solve_stitch(photos, names_of(photos.size()));
    ADD_FAILURE() << "was stitched";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(Stitch, WhatCannotBeIsAnError) {
  const Carpet world(7);
  std::vector<Shot> shots = photograph_around(world, 7, {2, 50, 5});
  expect_error(photos_of(shots), "enough of the same");
  expect_error({{shots[0].picture}}, "one photograph");
  expect_error({{shots[0].picture}, {shots[0].picture}}, "the same photograph");
}

/// Where all photographs clip, a wall of the middle channel: what the sphere shows behind the first one's middle.
float light_where_all_clip(const std::vector<double>& gains) {
  constexpr double kCeiling = 0.98;
  const Image<float> white = [] {
    Image<float> picture(64, 64, 3);
    for (int y = 0; y < 64; ++y) std::fill_n(picture.pixel(0, y), 3 * 64, 1.0f);
    return picture;
  }();
  std::vector<StitchPhoto> photos;
  Stitch stitch;
  for (std::size_t k = 0; k < gains.size(); ++k) {
    photos.push_back({white, {}, {}, kCeiling, {}});
    StitchedPhoto view;
    view.used = true;
    view.lens = {{64, 64}, 60};
    view.probe_from_view = rotation_from_degrees({0, 3.0 * static_cast<double>(k), 0});
    view.gain = gains[k];
    stitch.photos.push_back(view);
  }
  const RadianceMap map = merge_stitch(photos, stitch, 64);
  const Vec2 ahead = LatLong{{64, 32}}.px_from_dir(Vec3::UnitZ()).value();
  return map.rgb(static_cast<int>(ahead.x()), static_cast<int>(ahead.y()), 1);
}

// A clipped pixel bounds the light from below; the mean of bounds is lower than the best of them.
TEST(Stitch, WhereAllClipTheGreatestBoundIsKept) {
  EXPECT_NEAR(light_where_all_clip({1, 2}), 2, 1e-5);
  EXPECT_NEAR(light_where_all_clip({2, 4, 1}), 4, 1e-5);
}

TEST(Stitch, TheHorizonIsLevelled) {
  const Carpet world(8);
  std::vector<Shot> shots = photograph_around(world, 8, {6, 80, 10});
  const Stitch stitch = solve(shots, {.level = true});
  // Up as the photographs' horizontals have it; their rolls of some degrees cancel to one or so.
  const Vec3 up = stitch.photos[0].probe_from_view * shots[0].world_from_view.transpose() * Vec3::UnitY();
  EXPECT_LT(std::acos(std::min(1.0, up.y())) / kDegree, 3);
  const Vec3 ahead = stitch.photos[0].probe_from_view.col(2);
  EXPECT_NEAR(ahead.x(), 0, 1e-9) << "the first photograph is in the middle";
  EXPECT_GT(ahead.z(), 0);
}

TEST(FillNadir, TheMembraneMeetsItsBorder) {
  constexpr int kWidth = 256;
  RadianceMap map;
  map.rgb = test::latlong_of(kWidth, [](const Vec3& d, int c) { return 2 + 0.5 * d.x() + 0.3 * c * d.z(); });
  map.alpha = Image<float>(kWidth, kWidth / 2, 1);
  double truth = 0;
  for (int y = 0; y < kWidth / 2; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool shown =
          dir_from_latlong((x + 0.5) / kWidth, (y + 0.5) / (0.5 * kWidth)).y() > -0.8 - 0.1 * std::sin(0.1 * x);
      map.alpha(x, y) = shown || (x == 3 && y == 3) ? 1.0f : 0.0f;
      if (!shown) std::fill_n(map.rgb.pixel(x, y), 3, 0.0f);
      if (!shown) truth += latlong_pixel_solid_angle(y, kWidth, kWidth / 2);
    }
  }
  map.alpha(10, 5) = 0;  // another hole
  const NadirFill fill = fill_nadir(map);
  EXPECT_NEAR(fill.solid_angle, truth, 1e-9);
  EXPECT_EQ(map.alpha(10, 5), 0);
  for (int y = kWidth / 3; y < kWidth / 2; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / kWidth, (y + 0.5) / (0.5 * kWidth));
      EXPECT_EQ(map.alpha(x, y), 1);
      // Harmonic on the plane as x and z of a flat disc are; on the ground's picture nearly so.
      EXPECT_NEAR(map.rgb(x, y, 1), 2 + 0.5 * d.x() + 0.3 * d.z(), 0.03);
    }
  }
  EXPECT_EQ(fill_nadir(map).solid_angle, 0) << "there is no hole any more";
}

}  // namespace
}  // namespace hdr
