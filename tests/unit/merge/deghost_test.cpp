// Laws of removing ghosts: what is still stays to the byte, what moved is shown whole and once.
#include "libhdr/merge/deghost.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "libhdr/core/parallel.h"
#include "libhdr/merge/merge.h"
#include "tests/support/movers.h"

namespace hdr {
namespace {

Alignment known(const test::MovingScene& scene, double residual_px = 0.02) {
  Alignment alignment;
  alignment.reference = static_cast<int>((scene.ref_from_photo.size() - 1) / 2);
  for (const Mat3& ref_from_photo : scene.ref_from_photo) {
    alignment.frames.emplace_back();
    alignment.frames.back().ref_from_photo = ref_from_photo;
    alignment.frames.back().residual_px = residual_px;
  }
  return alignment;
}

Merged merged(const Bracket& bracket, const test::MovingScene& scene, const test::MoverPlan& plan, bool deghost) {
  MergeOptions options;
  options.deghost = deghost;
  return merge(bracket, known(scene), plan.response, options);
}

bool same_bytes(const Image<float>& a, const Image<float>& b) {
  for (int y = 0; y < a.height(); ++y) {
    if (std::memcmp(a.row(y), b.row(y), a.row_samples() * sizeof(float)) != 0) return false;
  }
  return true;
}

void mark_lossy(Bracket& bracket) {
  for (Photo& photo : bracket.shots) photo.lossy = true;
}

/// Sizes, depths, responses, noise, brightness of the thing, hand shake: different ones for each seed.
test::MoverPlan random_plan(std::uint64_t seed) {
  Random random(seed, 0xd6);
  test::MoverPlan plan;
  plan.seed = seed;
  plan.size = {180 + static_cast<int>(random.bits() % 160), 120 + static_cast<int>(random.bits() % 100)};
  plan.scene_stops = 3 + 6 * random.uniform();
  const int shots = 3 + static_cast<int>(random.bits() % 4);
  const double step = random.uniform() < 0.3 ? 1 : 2;
  plan.evs.clear();
  for (int k = 0; k < shots; ++k) plan.evs.push_back(step * (k - (shots - 1) / 2));
  const char* responses[] = {"srgb", "gamma:2.2", "film"};
  plan.response = *response_from_name(responses[random.bits() % 3], 8);
  plan.noise = {2000 * std::exp2(5 * random.uniform()), 3 + 8 * random.uniform()};
  plan.object = 0.08 + 0.2 * random.uniform();
  plan.object_stops = (random.uniform() < 0.5 ? -1 : 1) * (1 + 1.5 * random.uniform());
  plan.step = plan.object * (0.5 + 0.8 * random.uniform());
  plan.shift = random.uniform() < 0.5 ? 0 : 5;
  return plan;
}

TEST(Deghost, WhatIsStillStaysToTheByte) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const test::MoverPlan plan = random_plan(seed);
    test::MovingScene scene = test::moving_scene(plan);
    if (seed % 2) mark_lossy(scene.still);
    const Merged plain = merged(scene.still, scene, plan, false), clean = merged(scene.still, scene, plan, true);
    EXPECT_TRUE(same_bytes(plain.map.rgb, clean.map.rgb)) << "seed " << seed << ": nothing moves in this bracket";
    EXPECT_EQ(clean.ghosts.share, 0) << seed;
    EXPECT_TRUE(clean.ghosts.mask.empty()) << seed;
  }
}

TEST(Deghost, WhatMovesLeavesLittleMoreErrorThanNothing) {
  std::vector<double> ratios;
  std::string table;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const test::MoverPlan plan = random_plan(seed);
    const test::MovingScene scene = test::moving_scene(plan);
    const auto p99 = [&](const Merged& map) {
      return test::error_quantile(test::closest_errors(map.map.rgb, scene, plan), 0.99);
    };
    const double still = p99(merged(scene.still, scene, plan, false));
    const double ghosts = p99(merged(scene.moving, scene, plan, false));
    const Merged clean = merged(scene.moving, scene, plan, true);
    ratios.push_back(p99(clean) / still);
    table += fmt::format("seed {:2}: still {:.4f}, with ghosts {:.4f}, without {:.4f}, ratio {:.2f}, {} regions\n",
                         seed, still, ghosts, p99(clean), ratios.back(), clean.ghosts.regions.size());
  }
  std::sort(ratios.begin(), ratios.end());
  // Things that are dark, large and before each other's places leave single short shots to show them: these are the
  // worst ones.
  EXPECT_LT(ratios[ratios.size() / 2], 1.8) << table;
  EXPECT_LT(ratios[ratios.size() * 7 / 10], 2.2) << table;
}

TEST(Deghost, TheThingIsShownOnceAndWholeWhereItStandsAlone) {
  test::MoverPlan plan;
  plan.object_stops = 2;
  plan.step = 0.18;  // no two places overlap
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    plan.seed = seed;
    const test::MovingScene scene = test::moving_scene(plan);
    const Merged clean = merged(scene.moving, scene, plan, true);
    for (std::size_t k = 0; k < scene.coverage.size(); ++k) {
      double shown = 0, all = 0;
      for (int y = 0; y < plan.size.height; ++y) {
        for (int x = 0; x < plan.size.width; ++x) {
          if (scene.coverage[k](x, y) < 1) continue;
          const double with = scene.truths[k + 1](x, y, 1), without = scene.truths[0](x, y, 1);
          if (std::abs(std::log2(with / without)) < 0.7) continue;
          const double value = clean.map.rgb(x, y, 1) / scene.map_per_scene;
          shown += std::abs(std::log2(value / with)) < std::abs(std::log2(value / without));
          all += 1;
        }
      }
      if (all < 50) continue;
      EXPECT_TRUE(shown < 0.05 * all || shown > 0.95 * all)
          << "seed " << seed << ", shot " << k << ": " << 100 * shown / all << " % of it is there";
    }
  }
}

TEST(Deghost, AwayFromTheRegionsNotAByteChangesAndRegionsAreNoSpeckle) {
  for (std::uint64_t seed = 21; seed <= 23; ++seed) {
    const test::MoverPlan plan = random_plan(seed);
    const test::MovingScene scene = test::moving_scene(plan);
    const Merged ghosts = merged(scene.moving, scene, plan, false), clean = merged(scene.moving, scene, plan, true);
    ASSERT_FALSE(clean.ghosts.regions.empty()) << seed;
    std::int64_t touched = 0, pixels = 0;
    for (int y = 0; y < plan.size.height; ++y) {
      for (int x = 0; x < plan.size.width; ++x) {
        touched += clean.ghosts.mask(x, y) > 0;
        if (clean.ghosts.mask(x, y) > 0) continue;
        for (int c = 0; c < 3; ++c) ASSERT_EQ(ghosts.map.rgb(x, y, c), clean.map.rgb(x, y, c)) << x << "," << y;
      }
    }
    EXPECT_NEAR(clean.ghosts.share, static_cast<double>(touched) / (plan.size.width * plan.size.height), 1e-9);
    for (const GhostRegion& region : clean.ghosts.regions) {
      EXPECT_GE(region.pixels, 25 * 4) << "five by five cells: a seed and its margin";
      EXPECT_FALSE(region.left_out.empty());
      for (const int shot : region.left_out) EXPECT_NE(shot, region.reference);
      pixels += region.pixels;
    }
    EXPECT_LT(std::abs(static_cast<double>(pixels - touched)), 0.25 * static_cast<double>(touched))
        << "the ramp reaches half a cell beyond";
  }
}

// What is behind a dark thing clips in the long shots. One short shot that shows the thing contradicts a middle one
// there; that is no reason to leave the middle one out, of which the long ones say that it is right.
TEST(Deghost, ADarkThingTakesNoShotThatShowsWhatIsBehindIt) {
  for (const std::uint64_t seed : {2, 3}) {  // 2.36 and 2.74 when such shots were left out
    test::MoverPlan plan;
    plan.size = {600, 400};
    plan.object_stops = -2;
    plan.seed = seed;
    const test::MovingScene scene = test::moving_scene(plan);
    const auto p99 = [&](const Merged& map) {
      return test::error_quantile(test::closest_errors(map.map.rgb, scene, plan), 0.99);
    };
    const double still = p99(merged(scene.still, scene, plan, false));
    EXPECT_LT(p99(merged(scene.moving, scene, plan, true)), 2 * still) << "seed " << seed;
  }
}

// 6 times the still bracket's when two places of one thing passed for the same, as bright and of one colour.
TEST(Deghost, AThingThatOverlapsItselfShowsTheTextureOfOneMoment) {
  test::MoverPlan plan;
  plan.size = {600, 400};
  plan.object = 0.35;
  plan.object_stops = 1;
  plan.step = 0.05;
  const test::MovingScene scene = test::moving_scene(plan);
  const auto p99 = [&](const Merged& map) {
    return test::error_quantile(test::closest_errors(map.map.rgb, scene, plan), 0.99);
  };
  const double still = p99(merged(scene.still, scene, plan, false));
  EXPECT_LT(p99(merged(scene.moving, scene, plan, true)), 1.6 * still);
}

TEST(Deghost, TheBytesDoNotDependOnThreads) {
  const test::MoverPlan plan = random_plan(33);
  const test::MovingScene scene = test::moving_scene(plan);
  set_threads(1);
  const Merged one = merged(scene.moving, scene, plan, true);
  set_threads(3);
  const Merged three = merged(scene.moving, scene, plan, true);
  set_threads(0);
  EXPECT_TRUE(same_bytes(one.map.rgb, three.map.rgb));
  EXPECT_EQ(one.ghosts.regions.size(), three.ghosts.regions.size());
}

// A lamp that clips in all shots but the shortest, and a thing that passes in front of it in one.
TEST(Deghost, WhatClipsIsNeverBelowItsBound) {
  for (const std::size_t before_lamp : {std::size_t{0}, std::size_t{1}, std::size_t{3}}) {
    Image<float> scene(160, 120, 3);
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        const float value = std::hypot(x - 80, y - 60) < 30 ? 3000.0f : 0.5f + 0.002f * static_cast<float>(x);
        std::fill_n(scene.pixel(x, y), 3, value);
      }
    }
    Bracket bracket;
    const Sensor sensor{srgb_response(8), NoiseModel{}, 0.18};
    for (std::size_t k = 0; k < 4; ++k) {
      Image<float> view = scene.clone();
      for (int y = 40; y < 80 && k == before_lamp; ++y) {
        for (int x = 60; x < 80; ++x) std::fill_n(view.pixel(x, y), 3, 0.3f);
      }
      Exposure exposure;
      exposure.seconds = std::exp2(2 * static_cast<double>(k) - 2);
      bracket.shots.push_back(expose(view, exposure, sensor, k));
      bracket.input_order.push_back(static_cast<int>(k));
    }
    MergeOptions options;
    options.deghost = true;
    const Merged clean = merge(bracket, no_alignment(bracket), sensor.response, options);
    const double saturation = sensor.response.exposure(1, 255) / (0.25 / clean.exposure_unit);
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        ASSERT_TRUE(std::isfinite(clean.map.rgb(x, y, 1)));
        const bool lamp = std::hypot(x - 80, y - 60) < 28;
        const bool passed = x > 55 && x < 85 && y > 35 && y < 85;
        if (!lamp || passed) continue;
        ASSERT_GE(clean.map.rgb(x, y, 1), 0.999 * saturation) << x << " " << y;
      }
    }
    // One thing in front of the lamp or the lamp itself, in all of it.
    int lamp = 0, thing = 0;
    for (int y = 44; y < 76; ++y) {
      for (int x = 64; x < 77; ++x) {
        lamp += clean.map.rgb(x, y, 1) > 0.9 * saturation;
        thing += clean.map.rgb(x, y, 1) < 0.1 * saturation;
      }
    }
    EXPECT_EQ(std::max(lamp, thing), 32 * 13) << "shot " << before_lamp << ": lamp " << lamp << ", thing " << thing;
  }
}

TEST(Deghost, OneShotAndTinyPicturesPass) {
  test::MoverPlan plan;
  plan.evs = {0};
  const test::MovingScene one = test::moving_scene(plan);
  EXPECT_EQ(merged(one.moving, one, plan, true).ghosts.share, 0);
  plan.evs = {-2, 0, 2};
  for (const Size size : {Size{1, 1}, Size{2, 3}, Size{16, 16}, Size{65, 1}}) {
    plan.size = size;
    const test::MovingScene scene = test::moving_scene(plan);
    const Merged clean = merged(scene.moving, scene, plan, true);
    EXPECT_TRUE(std::isfinite(clean.map.rgb(0, 0, 0)));
  }
}

}  // namespace
}  // namespace hdr
