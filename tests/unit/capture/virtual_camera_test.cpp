#include "capture/virtual/virtual_camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "capture/shoot.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

VirtualCamera camera_with_latency(int latency) {
  Image<float> scene = test::test_scene(64, 48, 4, 1);
  VirtualCameraOptions options;
  options.sensor.response = srgb_response(8);
  Exposure metered = options.optics;
  metered.seconds = 1.0 / 60;
  options.sensor.sensitivity = metered_sensitivity(scene, metered, 0.18);
  options.latency = latency;
  options.min_seconds = 1e-4;
  options.max_seconds = 1;
  return VirtualCamera("virtual:test", std::move(scene), options);
}

double mean_code(const Photo& photo) {
  const auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
  double sum = 0;
  for (int y = 0; y < codes.height(); ++y) {
    for (int x = 0; x < codes.width() * 3; ++x) sum += codes.row(y)[x];
  }
  return sum / (codes.width() * codes.height() * 3.0);
}

TEST(VirtualCamera, EveryKeptFrameHasTheAskedExposureWhateverTheLatency) {
  for (const int latency : {0, 1, 2, 4}) {
    VirtualCamera camera = camera_with_latency(latency);
    const std::vector<Frame> frames = shoot(camera, {1.0 / 1000, 1.0 / 60, 1.0 / 4});
    ASSERT_EQ(frames.size(), 3u);
    for (const Frame& frame : frames) {
      EXPECT_EQ(*frame.reported_seconds, frame.requested_seconds) << "latency " << latency;
      EXPECT_EQ(frame.photo.exposure.seconds, frame.reported_seconds);
      EXPECT_EQ(frame.verified, Verified::kMetadata);
    }
    EXPECT_LT(mean_code(frames[0].photo), mean_code(frames[1].photo));
    EXPECT_LT(mean_code(frames[1].photo), mean_code(frames[2].photo));
  }
}

TEST(VirtualCamera, AFrameStillInFlightShowsTheOldExposure) {
  VirtualCamera camera = camera_with_latency(2);
  camera.start();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  camera.set(0.25);
  EXPECT_DOUBLE_EQ(*camera.next_frame(deadline).reported_seconds, 1.0 / 60);
  EXPECT_DOUBLE_EQ(*camera.next_frame(deadline).reported_seconds, 1.0 / 60);
  EXPECT_DOUBLE_EQ(*camera.next_frame(deadline).reported_seconds, 0.25);
}

TEST(VirtualCamera, ExposuresBeyondTheDeviceAreItsLimits) {
  VirtualCamera camera = camera_with_latency(1);
  const std::vector<Frame> frames = shoot(camera, {1e-6, 30});
  EXPECT_DOUBLE_EQ(*frames[0].reported_seconds, 1e-4);
  EXPECT_DOUBLE_EQ(*frames[1].reported_seconds, 1);
  EXPECT_DOUBLE_EQ(frames[1].requested_seconds, 30);
}

TEST(VirtualCamera, CallsOutOfOrderAndImpossibleTimesSayWhatIsWrong) {
  VirtualCamera camera = camera_with_latency(0);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  try {
    camera.next_frame(deadline);
    FAIL() << "a camera that was not started gave a frame";
  } catch (const CameraError& error) {
    EXPECT_EQ(error.kind(), CameraError::Kind::kWrongState);
  }
  camera.start();
  EXPECT_THROW(camera.set(0), CameraError);
  EXPECT_THROW(camera.set(std::nan("")), CameraError);
  try {
    camera.next_frame(std::chrono::steady_clock::now() - std::chrono::seconds(1));
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
