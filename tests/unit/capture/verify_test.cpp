// Every kept frame has the exposure that it says: checked against the virtual camera's truth, which is not told.
#include "capture/verify.h"

#include <gtest/gtest.h>

#include <cmath>

#include "capture/shoot.h"
#include "capture/virtual/virtual_camera.h"
#include "tests/support/support.h"
#include "tests/unit/capture/witness.h"

namespace hdr {
namespace {

using test::joined;
using test::Witness;

VirtualCameraOptions blind() {
  VirtualCameraOptions options;
  options.metadata = false;
  options.seconds = {1e-4, 4, 0};
  return options;
}

Witness camera_of(const VirtualCameraOptions& options, double stops = 8) {
  return Witness("virtual:test", test::test_scene(96, 72, stops, 5), options);
}

void expect_truth(const Witness& camera, const Take& take, const std::string& what) {
  for (const Frame& frame : take.frames) {
    ASSERT_TRUE(frame.exposure.has_value()) << what;
    EXPECT_NE(frame.verified, Verified::kNone) << what;
    EXPECT_NEAR(std::log2(frame.exposure->total() / camera.truth(frame).total()), 0, 0.01)
        << what << ": frame " << frame.sequence << " says " << frame.exposure->seconds << " s and had "
        << camera.truth(frame).seconds << " s";
  }
}

TEST(Verify, ByBrightnessWhateverTheResponseAndTheLatency) {
  BracketRequest request;
  request.times = {1.0 / 1000, 1.0 / 250, 1.0 / 60, 1.0 / 15, 1.0 / 4};
  for (const char* response : {"srgb", "linear", "gamma:2.2", "film"}) {
    for (int latency = 0; latency <= 8; ++latency) {
      VirtualCameraOptions options = blind();
      options.response = response;
      options.latency = latency;
      Witness camera = camera_of(options);
      const std::string what = std::string(response) + " latency " + std::to_string(latency);
      const Take take = shoot(camera, request);
      EXPECT_EQ(take.frames.size(), 5u) << what << ": " << joined(take.warnings);
      EXPECT_EQ(take.latency, latency) << what;
      expect_truth(camera, take, what);
    }
  }
}

TEST(Verify, ASilentClampIsFoundWhereverItIs) {
  BracketRequest request;
  request.times = {1.0 / 1000, 1.0 / 250, 1.0 / 60, 1.0 / 15, 1.0 / 4};
  for (const char* response : {"srgb", "linear", "gamma:2.2", "film"}) {
    for (const double clamp : {1.0 / 400, 1.0 / 100, 1.0 / 45, 1.0 / 30, 1.0 / 22, 1.0 / 10, 1.0 / 5}) {
      VirtualCameraOptions options = blind();
      options.response = response;
      options.faults.clamp_seconds = clamp;
      Witness camera = camera_of(options);
      const std::string what = std::string(response) + " clamp " + std::to_string(clamp);
      const Take take = shoot(camera, request);
      std::size_t possible = 0;
      for (const double t : request.times) possible += t <= clamp;
      // Less than .14 EV cannot be told.
      expect_truth(camera, take, what);
      EXPECT_EQ(take.frames.size(), possible) << what << ": " << joined(take.warnings);
    }
  }
}

}  // namespace
}  // namespace hdr
