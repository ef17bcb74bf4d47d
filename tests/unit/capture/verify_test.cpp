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

TEST(Verify, ABracketTakesItsExposuresAndThreeFramesMoreThanTheLatencyForEachShot) {
  BracketRequest request;
  request.times = {1.0 / 1000, 1.0 / 250, 1.0 / 55, 1.0 / 15, 1.0 / 4};
  for (const bool metadata : {false, true}) {
    for (int latency = 0; latency <= 8; ++latency) {
      VirtualCameraOptions options = blind();
      options.metadata = metadata;
      options.latency = latency;
      Witness camera = camera_of(options);
      const Take take = shoot(camera, request);
      double limit = 0;
      for (const double t : request.times) limit += t + (3 + latency) * std::max(t, options.frame_seconds);
      EXPECT_EQ(take.frames.size(), 5u);
      EXPECT_LE(take.bracket_seconds, limit) << "latency " << latency << " metadata " << metadata;
      EXPECT_GT(take.bracket_seconds, 0);
    }
  }
}

TEST(Verify, ADeviceThatMetersOnOrDoesNotListenIsRefused) {
  BracketRequest request;
  request.times = {1.0 / 250, 1.0 / 60};
  for (const bool automatic : {true, false}) {
    VirtualCameraOptions options = blind();
    options.faults.automatic = automatic;
    if (!automatic) options.faults.stuck = 0;
    Witness camera = camera_of(options);
    const auto started = camera.now();
    try {
      shoot(camera, request);
      FAIL() << "frames of a camera that does what it likes were kept";
    } catch (const CameraError& error) {
      EXPECT_EQ(error.kind(), CameraError::Kind::kNotSupported) << error.what();
      EXPECT_NE(std::string(error.what()).find("does not follow"), std::string::npos) << error.what();
    }
    EXPECT_LT(camera.now() - started, std::chrono::seconds(10));
  }
}

TEST(Verify, AControlThatSticksInMidBracketCostsTheShotsAfterIt) {
  BracketRequest request;
  request.times = {1.0 / 400, 1.0 / 60, 1.0 / 15, 1.0 / 4};
  for (const bool metadata : {true, false}) {
    for (const int stuck : {2, 3}) {  // the first calls are those of the preparation
      VirtualCameraOptions options = blind();
      options.metadata = metadata;
      options.faults.stuck = stuck;
      if (metadata) --options.faults.stuck;
      Witness camera = camera_of(options);
      const Take take = shoot(camera, request);
      EXPECT_LT(take.frames.size(), 4u);
      EXPECT_EQ(take.frames.size() + take.warnings.size(), 4u) << joined(take.warnings);
      expect_truth(camera, take, "stuck");
    }
  }
}

TEST(Verify, WhatCannotBeSeenIsNotKept) {
  // Nothing but black: the lens is shut.
  VirtualCameraOptions options = blind();
  options.sensitivity = 1;
  Witness shut("virtual:shut", Image<float>(96, 72, 3), options);
  BracketRequest request;
  request.times = {1.0 / 60};
  try {
    shoot(shut, request);
    FAIL() << "the exposure of a black picture cannot be known";
  } catch (const CameraError& error) {
    EXPECT_EQ(error.kind(), CameraError::Kind::kTimeout) << error.what();
  }
  // A shot so short that it is black, and one that is white all over, beside one that shows something.
  request.times = {1e-5, 1.0 / 60, 4};
  options = blind();
  options.seconds.min = 1e-6;
  Witness camera = camera_of(options, 2);
  const Take take = shoot(camera, request);
  ASSERT_EQ(take.frames.size(), 1u) << joined(take.warnings);
  EXPECT_DOUBLE_EQ(take.frames[0].exposure->seconds, 1.0 / 60);
  EXPECT_EQ(take.warnings.size(), 2u) << joined(take.warnings);
}

TEST(Verify, FlickerIsNoReasonToKeepAFrameThatIsOff) {
  // 100 Hz and frames of 1/60 s: whole periods are steady, the others are not.
  VirtualCameraOptions options = blind();
  options.flicker_hz = 100;
  options.flicker_depth = 0.4;
  options.frame_seconds = 1.0 / 27;
  BracketRequest request;
  request.mains_hz = 50;
  request.grid = BracketRequest::Grid{1, 3};
  Witness camera = camera_of(options, 6);
  const Take take = shoot(camera, request);
  EXPECT_GE(take.frames.size(), 2u) << joined(take.warnings);
  for (const Frame& frame : take.frames) {
    if (frame.exposure->seconds < 0.01) continue;
    const double periods = frame.exposure->seconds * 100;
    EXPECT_NEAR(periods, std::round(periods), 1e-9);
  }
  expect_truth(camera, take, "flicker");
}

TEST(Brightness, GammaAndRatioAreToldApartByEqualStepsOnly) {
  // Truth: a gamma of 2.2 and steps of 1 EV, against linear light and steps of .45 EV: one step looks the same.
  const auto steps_of = [](const std::string& response, double step) {
    std::vector<Appearance> looks;
    VirtualCameraOptions options = blind();
    options.response = response;
    options.latency = 0;
    Witness camera = camera_of(options);
    camera.start({1.0 / 120, 1});
    for (int k = 0; k < 4; ++k) {
      camera.set({1.0 / 120 * std::exp2(k * step), 1});
      looks.push_back(appearance_of(camera.next_frame(camera.now() + std::chrono::seconds(9))));
    }
    return looks;
  };
  for (const char* response : {"gamma:2.2", "srgb", "film", "linear"}) {
    const std::vector<Appearance> seen = steps_of(response, 1);
    BrightnessModel model(seen[0].usable);
    const auto before = model.ratio(seen[0], seen[1]);
    ASSERT_TRUE(before);
    EXPECT_GT(before->deviation, 0.1) << "one step of an unknown response proves little";
    EXPECT_NEAR(before->ln_ratio, std::log(2), 3 * before->deviation) << response;
    model.learn(seen[0], seen[1], std::log(2));
    model.learn(seen[1], seen[2], std::log(2));
    const auto after = model.ratio(seen[1], seen[3]);
    ASSERT_TRUE(after);
    EXPECT_NEAR(after->ln_ratio, 2 * std::log(2), 0.1) << response;
    EXPECT_LT(after->deviation, before->deviation) << response;
    const auto none = model.ratio(seen[2], seen[2]);
    ASSERT_TRUE(none);
    EXPECT_NEAR(none->ln_ratio, 0, 1e-9);
  }
}

}  // namespace
}  // namespace hdr
