#include "libhdr/probe/ball_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/photograph.h"
#include "libhdr/probe/photographer.h"
#include "tests/support/rounds.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

double degrees_between(const Mat3& a, const Mat3& b) {
  return std::acos(std::clamp(0.5 * ((a.transpose() * b).trace() - 1), -1.0, 1.0)) / kDegree;
}

/// Photographs of one ball in a textured room, each from another place, its photographer in it. `alike`: what the
/// room's other end has of this one; at 0.5 both are the same.
struct Photographs {
  Photographs(std::uint64_t seed, const std::vector<Vec3>& turns, const std::vector<double>& distances,
              const std::vector<double>& gains, bool distances_known, double alike = 0)
      : room(seed, 0.4) {
    const Image<float> scene = test::latlong_of(512, [&](const Vec3& d, int c) {
      return std::pow(room(d, c), 1 - alike) * std::pow(room({-d.x(), d.y(), -d.z()}, c), alike);
    });
    Random random(seed, 9);
    for (std::size_t k = 0; k < turns.size(); ++k) {
      MirrorBall ball{{200 + 3 * random.uniform(), 160 + 3 * random.uniform(), 145}, distances[k]};
      if (!distances_known) ball.principal = Vec2(200, 160);  // of the whole picture, as is taken for it
      scene_from_view.push_back(rotation_from_degrees(turns[k]));
      Image<float> picture =
          photograph_ball(with_photographer(scene, 8, scene_from_view[k]), {400, 320}, ball, 35, scene_from_view[k]);
      for (int y = 0; y < 320; ++y) {
        for (int x = 0; x < 1200; ++x) {
          float& value = picture.row(y)[x];
          value = static_cast<float>(value / gains[k] * (1 + 0.01 * random.normal()));
        }
      }
      pictures.push_back(std::move(picture));
      views.push_back({pictures[k], distances_known ? ball : MirrorBall{ball.disc}, true, distances_known, {}, {}});
      names.push_back("view " + std::to_string(k + 1));
    }
  }
  Mat3 true_probe_from_view(std::size_t k) const { return scene_from_view[0].transpose() * scene_from_view[k]; }

  test::SoftRoom room;
  std::vector<Mat3> scene_from_view;
  std::vector<Image<float>> pictures;
  std::vector<BallView> views;
  std::vector<std::string> names;
};

std::vector<RegisteredView> expect_registered(const Photographs& p, const std::vector<double>& gains,
                                              const std::vector<double>& distances, const std::string& which) {
  const std::vector<RegisteredView> found = register_ball_views(p.views, p.names);
  EXPECT_TRUE(found[0].probe_from_view.isIdentity(0)) << "the first view sets the axes";
  EXPECT_EQ(found[0].gain, 1);
  for (std::size_t k = 1; k < found.size(); ++k) {
    EXPECT_LT(degrees_between(found[k].probe_from_view, p.true_probe_from_view(k)), 0.1) << which << " view " << k;
    EXPECT_NEAR(found[k].gain / (gains[k] / gains[0]), 1, 0.01) << which << " view " << k;
    EXPECT_LT(found[k].overlap_rms, 0.1) << which;
    EXPECT_NEAR(1 / found[k].ball.distance, 1 / distances[k], 0.01) << which << " view " << k;
  }
  return found;
}

TEST(BallViews, NinetyDegreesApartTheRotationIsFound) {
  for (std::uint64_t seed = 1; seed < 1 + test::rounds(3); ++seed) {
    Random random(seed, 10);
    const Vec3 first(0, 360 * random.uniform(), 0);
    const Vec3 second = first + Vec3(10 * random.uniform() - 5, 90, 10 * random.uniform() - 5);
    expect_registered({seed, {first, second}, {kFar, kFar}, {1, 1.3}, true}, {1, 1.3}, {kFar, kFar},
                      "far, seed " + std::to_string(seed));
  }
  expect_registered({11, {{0, 10, 0}, {3, 100, 2}}, {8, 12}, {1, 0.8}, true}, {1, 0.8}, {8, 12}, "near");
}

TEST(BallViews, UnknownDistancesAreFoundWithTheRotation) {
  expect_registered({21, {{0, 10, 0}, {2, 95, -4}}, {7, 10}, {1, 1}, false}, {1, 1}, {7, 10}, "two");
  expect_registered({22, {{0, 10, 0}, {2, 130, -4}, {0, 240, 5}}, {12, kFar, 20}, {1, 1.1, 0.9}, false}, {1, 1.1, 0.9},
                    {12, kFar, 20}, "three");
}

// What finds a ball is right to half a pixel or so, which at this size is 0.3 degrees in the middle of the ball.
TEST(BallViews, OutlinesThatAreAPixelOffAreMendedWithTheRotation) {
  for (std::uint64_t seed = 51; seed < 51 + test::rounds(3); ++seed) {
    Photographs p(seed, {{0, 10, 0}, {2, 100, -4}}, {9, 15}, {1, 1}, false);
    const double off[2][3] = {{0.7, -0.5, 0.3}, {-0.6, -0.7, -0.4}};
    for (std::size_t k = 0; k < 2; ++k) {
      p.views[k].outline_known = false;
      p.views[k].ball.disc.cx += off[k][0];
      p.views[k].ball.disc.cy += off[k][1];
      p.views[k].ball.disc.r += off[k][2];
    }
    expect_registered(p, {1, 1}, {9, 15}, "seed " + std::to_string(seed));
  }
}

// A courtyard: from afar half a turn more is as good.
TEST(BallViews, OfTwoEndsThatLookAlikeTheRightOneIsTaken) {
  for (std::uint64_t seed = 61; seed < 61 + test::rounds(3); ++seed) {
    const Photographs p(seed, {{0, 10, 0}, {2, 100, -4}}, {9, 15}, {1, 1}, false, 0.4);
    const RegisteredView found = expect_registered(p, {1, 1}, {9, 15}, "seed " + std::to_string(seed))[1];
    EXPECT_GT(found.runner_up, 0.3) << "the other end is known of";
    EXPECT_FALSE(found.ambiguous()) << found.correlation << " against " << found.runner_up;
  }
  const Photographs same(64, {{0, 10, 0}, {2, 100, -4}}, {9, 15}, {1, 1}, true, 0.5);
  EXPECT_TRUE(register_ball_views(same.views, same.names)[1].ambiguous()) << "nothing tells the two ends apart";
}

TEST(BallViews, OnePhotographTwiceIsRefused) {
  const Photographs p(35, {{0, 0, 0}}, {kFar}, {1}, true);
  try {
    register_ball_views({p.views[0], p.views[0]}, {"a.exr", "b.exr"});
    ADD_FAILURE() << "registered with itself";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("b.exr: the same photograph as a.exr"), std::string::npos) << e.what();
  }
}

TEST(BallViews, OtherRoomsAreRefused) {
  for (std::uint64_t seed = 31; seed < 31 + test::rounds(2); ++seed) {
    Photographs here(seed, {{0, 0, 0}}, {kFar}, {1}, true), elsewhere(seed + 100, {{0, 90, 0}}, {kFar}, {1}, true);
    try {
      const auto found = register_ball_views({here.views[0], elsewhere.views[0]}, {"here.exr", "elsewhere.exr"});
      ADD_FAILURE() << "registered with correlation " << found[1].correlation;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("elsewhere.exr"), std::string::npos) << e.what();
    }
  }
}

TEST(BallViews, TogetherTheyShowEverythingAndNobody) {
  const Photographs p(41, {{0, 20, 0}, {2, 110, -3}}, {10, 10}, {1, 1.2}, true);
  const auto registered = register_ball_views(p.views, p.names);
  const Size size{256, 128};
  const Image<float> joined = join_ball_views(p.views, registered, LatLong{size}, size).rgb;
  const Image<float> alone = join_ball_views({p.views[0]}, {registered[0]}, LatLong{size}, size).rgb;
  int wrong = 0, wrong_alone = 0, dark = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height);
      const double truth = p.room(p.scene_from_view[0] * d, 1);
      ASSERT_TRUE(std::isfinite(joined(x, y, 1)));
      dark += joined(x, y, 1) <= 0 ? 1 : 0;
      wrong += std::abs(std::log2(std::max(1e-6f, joined(x, y, 1)) / truth)) > 0.5 ? 1 : 0;
      wrong_alone += std::abs(std::log2(std::max(1e-6f, alone(x, y, 1)) / truth)) > 0.5 ? 1 : 0;
    }
  }
  EXPECT_EQ(dark, 0) << "the merged probe covers the sphere";
  EXPECT_LT(wrong, 0.005 * size.width * size.height) << "of " << wrong_alone << " in one view alone";
  EXPECT_GT(wrong_alone, 0.02 * size.width * size.height) << "the photographer was there";
}

/// Views of a uniform room, with noise of a known deviation.
struct NoisyViews {
  NoisyViews(std::uint64_t seed, const MirrorBall& ball) {
    Random random(seed, 31);
    for (int k = 0; k < 2; ++k) {
      Image<float> picture(120, 100, 3), deviation(120, 100, 3);
      for (int y = 0; y < 100; ++y) {
        for (int x = 0; x < 360; ++x) {
          deviation.row(y)[x] = 0.3f + 0.002f * static_cast<float>(x);
          picture.row(y)[x] = 100 + deviation.row(y)[x] * static_cast<float>(random.normal());
        }
      }
      pictures.push_back(std::move(picture));
      deviations.push_back(std::move(deviation));
      views.push_back({pictures.back(), ball, true, true, {}, deviations.back()});
      registered.push_back({rotation_from_degrees({0, 90.0 * k, 0}), k == 0 ? 1.0 : 1.25, ball, 0, 1});
    }
  }
  std::vector<Image<float>> pictures, deviations;
  std::vector<BallView> views;
  std::vector<RegisteredView> registered;
};

TEST(BallViews, DeviationsOfTheJoinedSphereAreThoseOfTheNoise) {
  const MirrorBall ball{{60, 50, 45}, 9};
  const Size size{96, 48};
  Image<float> mean;
  {
    NoisyViews quiet(1, ball);
    for (auto& picture : quiet.pictures) {
      for (int y = 0; y < 100; ++y) std::fill_n(picture.row(y), 360, 100.0f);
    }
    mean = join_ball_views(quiet.views, quiet.registered, LatLong{size}, size).rgb;
  }
  double squares = 0;
  int count = 0;
  for (std::uint64_t draw = 1; draw <= 24; ++draw) {
    const NoisyViews noisy(draw, ball);
    const RadianceMap joined = join_ball_views(noisy.views, noisy.registered, LatLong{size}, size);
    EXPECT_TRUE(joined.alpha.empty()) << "the two hide nothing in common";
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < 3 * size.width; ++x, ++count) {
        const double off = (joined.rgb.row(y)[x] - mean.row(y)[x]) / static_cast<double>(joined.stddev.row(y)[x]);
        squares += off * off;
      }
    }
  }
  EXPECT_NEAR(std::sqrt(squares / count), 1, 0.02);
}

TEST(BallViews, WhatNobodySawHasNoAlpha) {
  const NoisyViews p(1, MirrorBall{{60, 50, 45}, 3});
  const Size size{180, 90};
  const RadianceMap alone = join_ball_views({p.views[0]}, {p.registered[0]}, LatLong{size}, size);
  ASSERT_FALSE(alone.alpha.empty());
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      // 19.5 degrees around -Z lie behind the ball.
      const double behind = std::acos(-dir_from_latlong((x + 0.5) / 180, (y + 0.5) / 90).z()) / kDegree;
      if (std::abs(behind - 19.47) < 1) continue;
      EXPECT_EQ(alone.alpha(x, y), behind > 19.47 ? 1 : 0) << behind;
      EXPECT_EQ(alone.rgb(x, y, 1) > 0, behind > 19.47) << behind;
    }
  }
}

}  // namespace
}  // namespace hdr
