#include "capture/virtual/virtual_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "capture/shoot.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

VirtualCamera camera_with_latency(int latency) {
  VirtualCameraOptions options;
  options.latency = latency;
  options.seconds = {1e-4, 1, 0};
  return VirtualCamera("virtual:test", test::test_scene(64, 48, 4, 1), options);
}

double mean_code(const Frame& frame) {
  return std::accumulate(frame.bytes.begin(), frame.bytes.end(), 0.0) / static_cast<double>(frame.bytes.size());
}

Take shoot_times(Camera& camera, const std::vector<double>& times) {
  BracketRequest request;
  request.times = times;
  return shoot(camera, request);
}

TEST(VirtualCamera, EveryKeptFrameHasTheAskedExposureWhateverTheLatency) {
  for (const int latency : {0, 1, 2, 4}) {
    VirtualCamera camera = camera_with_latency(latency);
    const std::vector<Frame> frames = shoot_times(camera, {1.0 / 1000, 1.0 / 60, 1.0 / 4}).frames;
    ASSERT_EQ(frames.size(), 3u);
    for (const Frame& frame : frames) {
      EXPECT_EQ(frame.reported, frame.requested) << "latency " << latency;
      EXPECT_EQ(frame.exposure, frame.reported);
      EXPECT_EQ(frame.verified, Verified::kMetadata);
    }
    EXPECT_LT(mean_code(frames[0]), mean_code(frames[1]));
    EXPECT_LT(mean_code(frames[1]), mean_code(frames[2]));
  }
}

TEST(VirtualCamera, AFrameStillInFlightShowsTheOldExposure) {
  VirtualCamera camera = camera_with_latency(2);
  camera.start({1.0 / 60, 1});
  const auto deadline = camera.now() + std::chrono::seconds(5);
  camera.set({0.25, 1});
  EXPECT_DOUBLE_EQ(camera.next_frame(deadline).reported->seconds, 1.0 / 60);
  EXPECT_DOUBLE_EQ(camera.next_frame(deadline).reported->seconds, 1.0 / 60);
  EXPECT_DOUBLE_EQ(camera.next_frame(deadline).reported->seconds, 0.25);
}

TEST(VirtualCamera, CallsOutOfOrderAndImpossibleTimesSayWhatIsWrong) {
  VirtualCamera camera = camera_with_latency(0);
  const auto deadline = camera.now() + std::chrono::seconds(5);
  try {
    camera.next_frame(deadline);
    FAIL() << "a camera that was not started gave a frame";
  } catch (const CameraError& error) {
    EXPECT_EQ(error.kind(), CameraError::Kind::kWrongState);
  }
  camera.start({1.0 / 60, 1});
  EXPECT_THROW(camera.set({0, 1}), CameraError);
  EXPECT_THROW(camera.set({std::nan(""), 1}), CameraError);
  try {
    camera.next_frame(camera.now() - std::chrono::seconds(1));
    FAIL() << "a frame after its deadline";
  } catch (const CameraError& error) {
    EXPECT_EQ(error.kind(), CameraError::Kind::kTimeout);
  }
}

TEST(VirtualCamera, MetersTheMedianAtTheAskedLevel) {
  Image<float> scene(4, 1, 3);
  for (int k = 0; k < 12; ++k) scene.row(0)[k] = k < 5 ? 1.0f : k < 8 ? 2.0f : 50.0f;
  const Exposure exposure{0.5, std::nullopt, std::nullopt, 0};
  EXPECT_DOUBLE_EQ(metered_sensitivity(scene, exposure, 0.18) * 2 * 0.5, 0.18);
}

TEST(OpenCamera, UnknownSchemesNameWhatThereIs) {
  try {
    open_camera("firewire:0");
    FAIL();
  } catch (const CameraError& error) {
    EXPECT_EQ(error.kind(), CameraError::Kind::kNotSupported);
    EXPECT_NE(std::string(error.what()).find("virtual:"), std::string::npos);
  }
}

}  // namespace
}  // namespace hdr
