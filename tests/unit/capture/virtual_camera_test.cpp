#include "capture/virtual/virtual_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "capture/develop.h"
#include "capture/shoot.h"
#include "capture/virtual/built_in_scene.h"
#include "capture/virtual/virtual_uri.h"
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

Take shoot_times(CameraDevice& camera, const std::vector<double>& times) {
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

CameraError::Kind error_of(VirtualFaults faults, bool metadata) {
  VirtualCameraOptions options;
  options.faults = faults;
  options.metadata = metadata;
  options.seconds = {1e-4, 1, 0};
  VirtualCamera camera("virtual:test", test::test_scene(64, 48, 6, 1), options);
  const auto started = camera.now();
  try {
    shoot_times(camera, {1.0 / 500, 1.0 / 125, 1.0 / 30, 1.0 / 8});
  } catch (const CameraError& error) {
    EXPECT_LT(camera.now() - started, std::chrono::seconds(12)) << error.what();
    EXPECT_EQ(std::string(error.what()).rfind("virtual:test: ", 0), 0u) << error.what();
    camera.start({1.0 / 60, 1});  // it was stopped
    return error.kind();
  }
  ADD_FAILURE() << "the fault was not noticed";
  return CameraError::Kind::kWrongState;
}

TEST(VirtualCamera, EveryFaultIsItsError) {
  using Kind = CameraError::Kind;
  for (const bool metadata : {true, false}) {
    for (const int frame : {0, 1, 7, 12}) {
      EXPECT_EQ(error_of({.unplug = frame}, metadata), Kind::kDisconnected) << frame;
      EXPECT_EQ(error_of({.freeze = frame}, metadata), Kind::kTimeout) << frame;
    }
    for (const int call : {0, 2}) EXPECT_EQ(error_of({.stall = call}, metadata), Kind::kTimeout) << call;
    EXPECT_EQ(error_of({.dropped = 1}, metadata), Kind::kTimeout) << "no frame at all";
  }
  const auto kind_at_start = [](VirtualFaults faults) {
    VirtualCameraOptions options;
    options.faults = faults;
    VirtualCamera camera("virtual:test", test::test_scene(16, 16, 4, 1), options);
    try {
      camera.start({1.0 / 60, 1});
    } catch (const CameraError& error) {
      return error.kind();
    }
    return Kind::kWrongState;
  };
  EXPECT_EQ(kind_at_start({.busy = true}), Kind::kBusy);
  EXPECT_EQ(kind_at_start({.permission = true}), Kind::kPermission);
  EXPECT_EQ(kind_at_start({.no_manual = true}), Kind::kNotSupported);
}

TEST(VirtualCamera, LostFramesAreGapsInTheSequenceAndTakeTheirTime) {
  VirtualCameraOptions options;
  options.faults.dropped = 0.5;
  VirtualCamera camera("virtual:test", test::test_scene(16, 16, 4, 1), options);
  camera.start({1.0 / 60, 1});
  const auto started = camera.now();
  Frame last;
  int gaps = 0;
  for (int k = 0; k < 20; ++k) {
    const Frame frame = camera.next_frame(camera.now() + std::chrono::seconds(9));
    gaps += k > 0 && frame.sequence != last.sequence + 1;
    EXPECT_NEAR(std::chrono::duration<double>(camera.now() - started).count(), (frame.sequence + 1) / 30.0, 1e-6);
    last = frame;
  }
  EXPECT_GE(gaps, 3);
}

TEST(VirtualCamera, EveryFormatIsWhatDevelopMakesOfIt) {
  // Grey patches of known light, without noise: each format gives them back.
  Image<float> scene(64, 16, 3);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 64; ++x) std::fill_n(scene.pixel(x, y), 3, 0.1f + 0.2f * static_cast<float>(x / 16));
  }
  for (const char* format : {"grey8", "grey10", "grey12", "grey16", "rgb8", "rgb16", "yuyv", "mjpeg", "bayer8",
                             "bayer10", "bayer12", "bayer16", "bayer10p", "bayer12p"}) {
    VirtualUri uri =
        parse_virtual_uri(std::string("virtual:?response=linear&read_noise=0&full_well=1e12&format=") + format);
    uri.options.sensitivity = 60 * 64;  // a 60th of a second at f/8 fills the well with unit radiance
    VirtualCamera camera("virtual:test", scene.clone(), uri.options);
    camera.start({1.0 / 60, 1});
    const Photo photo = develop(camera.next_frame(camera.now() + std::chrono::seconds(9)));
    ASSERT_EQ(photo.size(), scene.size()) << format;
    for (const int x : {8, 24, 40, 56}) {
      for (int c = 0; c < 3; ++c) {
        const double code = std::visit([&](const auto& codes) { return double(codes(x, 8, c)); }, photo.codes);
        EXPECT_NEAR(code / photo.max_code(), scene(x, 8, c), 0.012) << format << " at " << x;
      }
    }
  }
}

TEST(VirtualUri, SaysEverythingAndRefusesWhatItDoesNotKnow) {
  const VirtualUri uri = parse_virtual_uri(
      "virtual:a/b.exr?latency=4&metadata=0&format=bayer10p,yuyv&cfa=gbrg&seconds=1/1000..2:1e-4&gain=1..8&fps=25"
      "&flicker=100:.5&faults=dropped:.1,unplug:20,clamp:1/30,automatic");
  EXPECT_EQ(uri.scene, "a/b.exr");
  EXPECT_EQ(uri.options.latency, 4);
  EXPECT_FALSE(uri.options.metadata);
  EXPECT_EQ(uri.options.formats, (std::vector{PixelFormat::kBayer10Packed, PixelFormat::kYuyv}));
  EXPECT_EQ(uri.options.cfa, Cfa::kGbrg);
  EXPECT_DOUBLE_EQ(uri.options.seconds.min, 1e-3);
  EXPECT_DOUBLE_EQ(uri.options.seconds.step, 1e-4);
  EXPECT_DOUBLE_EQ(uri.options.gain.max, 8);
  EXPECT_DOUBLE_EQ(uri.options.frame_seconds, 0.04);
  EXPECT_DOUBLE_EQ(uri.options.flicker_depth, 0.5);
  EXPECT_EQ(uri.options.faults.unplug, 20);
  EXPECT_DOUBLE_EQ(uri.options.faults.clamp_seconds, 1.0 / 30);
  EXPECT_TRUE(uri.options.faults.automatic);
  for (const char* wrong : {"latency=x", "latency=-1", "lag=2", "format=jpeg2000", "seconds=1", "seconds=2..1",
                            "faults=fire", "response=R.json", "size=8x8", "fps=0", "cfa=rgb"}) {
    EXPECT_THROW(parse_virtual_uri(std::string("virtual:?") + wrong), CameraError) << wrong;
  }
}

TEST(BuiltInScene, IsARoomOfTwentyStopsWhateverTheThreads) {
  const Image<float> room = built_in_scene({96, 72});
  float least = HUGE_VALF, most = 0;
  for (int y = 0; y < 72; ++y) {
    for (int k = 0; k < 96 * 3; ++k) {
      ASSERT_TRUE(std::isfinite(room.row(y)[k]));
      least = std::min(least, room.row(y)[k]);
      most = std::max(most, room.row(y)[k]);
    }
  }
  EXPECT_GT(least, 0);
  EXPECT_GT(std::log2(most / least), 20);
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
