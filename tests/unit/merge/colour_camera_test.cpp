// Cameras whose sensors clip before a matrix makes colours, and whose highlights fade to white: what is still stays,
// what moves is found.
#include <gtest/gtest.h>

#include "tests/support/ghost_share.h"
#include "tests/support/movers.h"

namespace hdr {
namespace {

struct Camera {
  const char* name;
  test::ColourCamera camera;
};

std::vector<Camera> cameras() {
  return {{"late fade", {{}, 0, .8, .5}},
          {"vivid", {{-.66, -.12, -.19, -.30, .03, -.43}, .3, 1, 0}},
          {"fade to white", {{-.45, -.25, -.25, -.2, -.1, -.6}, .15, .7, 1}}};
}

test::MovingScene scene_of(const test::ColourCamera& camera) {
  test::MoverPlan plan;
  plan.size = {600, 400};
  plan.camera = camera;
  plan.colour = 1.5;
  return test::moving_scene(plan);
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
  ASSERT_GT(plain, 30000);
  for (const Camera& kind : cameras()) EXPECT_GT(found_pixels(scene_of(kind.camera)), 0.98 * plain) << kind.name;
}

}  // namespace
}  // namespace hdr
