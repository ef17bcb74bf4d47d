// Cameras whose sensors clip before a matrix makes colours, and whose highlights fade to white: what is still stays,
// what moves is found.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/ghost_share.h"
#include "tests/support/movers.h"
#include "tests/support/rounds.h"

namespace hdr {
namespace {

struct Camera {
  const char* name;
  test::ColourCamera camera;
};

std::vector<Camera> cameras() {
  std::vector<Camera> all{{"fade to white", {{-.45, -.25, -.25, -.2, -.1, -.6}, .15, .7, 1}},
                          {"late fade", {{}, 0, .8, .5}},
                          {"vivid", {{-.66, -.12, -.19, -.30, .03, -.43}, .3, 1, 0}}};
  all.resize(test::rounds(all.size()));
  return all;
}

test::MoverPlan plan_of(const test::ColourCamera& camera) {
  test::MoverPlan plan;
  plan.size = {450, 300};
  plan.camera = camera;
  plan.colour = 1.5;
  return plan;
}

test::MovingScene scene_of(const test::ColourCamera& camera) {
  return test::moving_scene(plan_of(camera));
}

// 2.1, 5.4 and 8.7 % when every colour that paled had moved.
TEST(ColourCamera, WhatIsStillStays) {
  for (const Camera& kind : cameras()) {
    EXPECT_LT(test::ghost_share(scene_of(kind.camera).still).beyond_sigma, 0.003) << kind.name;
  }
}

/// Of the thing's pixels in all shots, those at which a shot was left out.
double found_pixels(const test::MovingScene& scene) {
  const Calibration calibration = calibrate_debevec_malik(scene.moving);
  MergeOptions options;
  options.noise_estimate = calibration.noise;
  options.deghost = true;
  const Merged clean = merge(scene.moving, no_alignment(scene.moving), calibration.response, options);
  double found = 0;
  for (const Image<float>& coverage : scene.coverage) {
    for (int y = 0; y < clean.ghosts.mask.height(); ++y) {
      for (int x = 0; x < clean.ghosts.mask.width(); ++x) {
        found += coverage(x, y) == 1 && clean.ghosts.mask(x, y) > 0;
      }
    }
  }
  return found;
}

TEST(ColourCamera, WhatMovesIsFoundAsByACameraWithoutAMatrix) {
  const double plain = found_pixels(scene_of({}));
  ASSERT_GT(plain, 15000);
  for (const Camera& kind : cameras()) EXPECT_GT(found_pixels(scene_of(kind.camera)), 0.98 * plain) << kind.name;
}

/// What the camera makes of each moment of the scene, nothing moving.
std::vector<Image<float>> moments_of(const test::MovingScene& scene, const test::MoverPlan& plan,
                                     const Calibration& calibration) {
  MergeOptions options;
  options.noise_estimate = calibration.noise;
  std::vector<Image<float>> moments;
  for (const Image<float>& truth : scene.truths) {
    Bracket bracket;
    for (std::size_t k = 0; k < plan.evs.size(); ++k) {
      bracket.shots.push_back(test::movers::shot_of(truth, plan, k));
      bracket.input_order.push_back(static_cast<int>(k));
    }
    moments.push_back(merge(bracket, no_alignment(bracket), calibration.response, options).map.rgb.clone());
  }
  return moments;
}

// Of a thing at the edge of what a longer shot can show, specks are not clipped: too small, each, to be found. 1.1 % of
// this map showed them (and .2 % does, at the thing's edge).
TEST(ColourCamera, SpecksBetweenClippedPixelsDoNotShowThrough) {
  const test::MoverPlan plan = plan_of({{-.66, -.12, -.19, -.30, .03, -.43}, .3, 1, 0});
  const test::MovingScene scene = test::moving_scene(plan);
  const Calibration calibration = calibrate_debevec_malik(scene.moving);
  const std::vector<Image<float>> moments = moments_of(scene, plan, calibration);
  MergeOptions options;
  options.noise_estimate = calibration.noise;
  options.deghost = true;
  const Merged clean = merge(scene.moving, no_alignment(scene.moving), calibration.response, options);
  int off = 0, all = 0;
  for (int y = 0; y < plan.size.height; ++y) {
    for (int x = 0; x < plan.size.width; ++x, ++all) {
      double least = INFINITY;
      for (const Image<float>& moment : moments) {
        least = std::min<double>(least, std::abs(std::log2(clean.map.rgb(x, y, 1) / moment(x, y, 1))));
      }
      off += least > 0.4;
    }
  }
  EXPECT_LT(off, 0.004 * all);
}

}  // namespace
}  // namespace hdr
