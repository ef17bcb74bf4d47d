// The V4L2 camera over the kernel's own uvcvideo driver and the simulated camera. Runs in the virtual machine only.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <iostream>
#include <map>
#include <thread>

#include "capture/shoot.h"
#include "capture/v4l2/v4l2_camera.h"
#include "tests/camera/simulator.h"

namespace hdr::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Kind = CameraError::Kind;

std::unique_ptr<CameraDevice> open_simulated(const Simulator& simulator,
                                             const std::string& options = "format=YUYV&size=320x240") {
  return open_camera("v4l2:" + simulator.node() + "?" + options);
}

/// Runs it, and says which error came, if any, and after how long.
struct Outcome {
  std::optional<Kind> kind;
  std::string what;
  Clock::duration time{};
};
Outcome outcome_of(const std::function<void()>& run) {
  const auto start = Clock::now();
  Outcome outcome;
  try {
    run();
  } catch (const CameraError& error) {
    outcome.kind = error.kind();
    outcome.what = error.what();
  }
  outcome.time = Clock::now() - start;
  return outcome;
}

const std::vector<double> kTimes = {0.0005, 0.002, 0.008, 0.032, 0.128};

/// Every frame was really taken with the exposure that it says.
void expect_true_exposures(const std::vector<Frame>& frames, const Simulator& simulator, int stream = 1) {
  const auto used = simulator.used();
  for (const Frame& frame : frames) {
    ASSERT_NE(frame.verified, Verified::kNone) << "frame " << frame.sequence;
    const auto truth = std::ranges::find_if(used, [&](const Simulator::Used& u) {
      return u.stream == stream && u.sequence == static_cast<int>(frame.sequence);
    });
    ASSERT_NE(truth, used.end()) << "the sensor knows no frame " << frame.sequence;
    EXPECT_NEAR(frame.exposure->seconds, truth->exposure_100us * 1e-4, 1e-9) << "frame " << frame.sequence;
  }
}

/// A camera as it is, and what was asked of it when: how late it really obeys depends on the host too, whose frames
/// wait in the driver's queue while the one before is looked at.
class Witnessed : public CameraDevice {
 public:
  explicit Witnessed(CameraDevice& camera) : camera_(camera) {}
  Capabilities capabilities() const override { return camera_.capabilities(); }
  FrameFormat configure(const Configuration& configuration) override { return camera_.configure(configuration); }
  void start(const ExposureSetting& first) override {
    camera_.start(first);
    asked_.push_back({first.seconds, sequences_.size()});
  }
  void set(const ExposureSetting& setting) override {
    camera_.set(setting);
    asked_.push_back({setting.seconds, sequences_.size()});
  }
  Frame next_frame(Clock::time_point deadline) override {
    Frame frame = camera_.next_frame(deadline);
    sequences_.push_back(frame.sequence);
    return frame;
  }
  void stop() override { camera_.stop(); }

  /// For each change of the exposure time, by the sensor's log: numbers of frames between the last that had come when
  /// it was asked for, and the first to come that obeys. The first change, from what start() asked for, is the one that
  /// shoot() learns its latency from. Changes before any frame and those which no frame obeyed are left out.
  std::vector<int> latencies(const std::vector<Simulator::Used>& used) const {
    std::map<int, double> truth;
    for (const Simulator::Used& u : used) {
      if (u.stream == 1) truth[u.sequence] = u.exposure_100us * 1e-4;
    }
    std::vector<int> all;
    for (std::size_t k = 1; k < asked_.size(); ++k) {
      const Asked& to = asked_[k];
      if (to.frames == 0 || std::abs(to.seconds - asked_[k - 1].seconds) < 1e-6) continue;
      const std::size_t end = k + 1 < asked_.size() ? asked_[k + 1].frames : sequences_.size();
      for (std::size_t i = to.frames; i < end; ++i) {
        const auto at = truth.find(static_cast<int>(sequences_[i]));
        if (at == truth.end() || std::abs(at->second - to.seconds) > 1e-6) continue;
        all.push_back(static_cast<int>(sequences_[i] - sequences_[to.frames - 1]) - 1);
        break;
      }
    }
    return all;
  }

 private:
  struct Asked {
    double seconds;
    std::size_t frames;  ///< that had come by then
  };
  CameraDevice& camera_;
  std::vector<std::uint32_t> sequences_;
  std::vector<Asked> asked_;
};

class Latency : public ::testing::TestWithParam<int> {};

TEST_P(Latency, EveryKeptFrameHasTheExposureThatItSays) {
  const Simulator simulator({"--latency", std::to_string(GetParam()), "--noise"});
  const auto camera = open_simulated(simulator);
  Witnessed witnessed(*camera);
  // The law of a bracket's time, in the camera's own: frames of a shot that came after it was asked for. Nothing tells
  // when the first shot was.
  int frames = 0, most = 0;
  std::optional<Clock::time_point> begun;
  ShootOptions options;
  options.on_frame = [&](const Frame& frame) { frames += begun && frame.timestamp >= begun->time_since_epoch(); };
  options.progress = [&](std::size_t, std::size_t) {
    most = std::max(most, frames);
    frames = 0;
    begun = Clock::now();
  };
  const Take take = shoot(witnessed, {.times = kTimes}, options);
  EXPECT_EQ(take.frames.size(), kTimes.size()) << (take.warnings.empty() ? "" : take.warnings.front());
  expect_true_exposures(take.frames, simulator);
  const std::vector<int> truth = witnessed.latencies(simulator.used());
  ASSERT_GE(truth.size(), kTimes.size() - 1);
  const auto [least, greatest] = std::ranges::minmax(truth);
  EXPECT_GE(least, GetParam()) << "USB's own comes on top of the sensor's";
  EXPECT_GE(take.latency, least);
  EXPECT_LE(take.latency, greatest + 1) << "a frame may be missed: damaged, or too dark to tell";
  EXPECT_LE(most, 3 + std::max(take.latency, greatest)) << "frames for a shot";
  EXPECT_GT(most, 0);
  std::cout << "  latency " << take.latency << ", by the sensor " << least << " to " << greatest << ": at most " << most
            << " frames a shot\n";
}

INSTANTIATE_TEST_SUITE_P(V4l2, Latency, ::testing::Values(0, 1, 2, 3, 4));

TEST(V4l2, IsListedAndDescribesItself) {
  const Simulator simulator;
  const auto cameras = list_cameras();
  EXPECT_TRUE(std::ranges::any_of(cameras, [&](const CameraName& c) { return c.uri == "v4l2:" + simulator.node(); }));
  const auto camera = open_camera("v4l2:" + simulator.node() + "?black=4096");
  const Capabilities can = camera->capabilities();
  EXPECT_TRUE(can.manual_exposure);
  EXPECT_NEAR(can.seconds.min, 1e-4, 1e-12);
  EXPECT_NEAR(can.seconds.max, 1.0, 1e-9);
  EXPECT_NEAR(can.gain.max, 255.0 / 16, 1e-9);
  EXPECT_NEAR(can.frame_seconds, 1.0 / 30, 1e-4);
  ASSERT_EQ(can.formats.size(), 8u);
  EXPECT_EQ(to_text(can.formats.front()), "RGGB 16 bit 640x480");
  EXPECT_EQ(can.formats.front().black_level, 4096);
}

TEST(V4l2, FramesThatAreDamagedOrLostAreMissedByTheirNumbersOnly) {
  const Simulator simulator({"--damage-every", "5", "--lose-every", "7"});
  const auto camera = open_simulated(simulator);
  camera->start({0.01, 1});
  std::vector<std::uint32_t> numbers;
  for (int k = 0; k < 12; ++k) {
    const Frame frame = camera->next_frame(Clock::now() + 3s);
    EXPECT_TRUE(frame.is_whole());
    EXPECT_EQ(frame.bytes.size(), 320u * 240 * 2);
    numbers.push_back(frame.sequence);
  }
  camera->stop();
  for (const std::uint32_t number : numbers) EXPECT_NE((number + 1) % 5, 0u) << "frame " << number << " was damaged";
  EXPECT_GT(numbers.back() - numbers.front(), 12u);
}

TEST(V4l2, ABracketSurvivesBadFrames) {
  const Simulator simulator({"--damage-every", "4", "--lose-every", "9", "--noise"});
  const auto camera = open_simulated(simulator);
  const Take take = shoot(*camera, {.times = kTimes});
  EXPECT_EQ(take.frames.size(), kTimes.size());
  expect_true_exposures(take.frames, simulator);
}

TEST(V4l2, UnpluggedInMidBracket) {
  const Simulator simulator({"--unplug-at-frame", "14"});
  const auto camera = open_simulated(simulator);
  const Outcome outcome = outcome_of([&] { shoot(*camera, {.times = kTimes}); });
  EXPECT_EQ(outcome.kind, Kind::kDisconnected) << outcome.what;
  EXPECT_LT(outcome.time, 5s);
}

TEST(V4l2, UnpluggedWhileWaiting) {
  const Simulator simulator;
  const auto camera = open_simulated(simulator);
  camera->start({0.01, 1});
  camera->next_frame(Clock::now() + 3s);
  simulator.unplug();
  const Outcome outcome = outcome_of([&] {
    while (true) camera->next_frame(Clock::now() + 3s);
  });
  EXPECT_EQ(outcome.kind, Kind::kDisconnected) << outcome.what;
  EXPECT_LT(outcome.time, 3s);
}

TEST(V4l2, AControlThatIsNeverAnsweredEndsInTime) {
  const Simulator simulator({"--silent-exposure"});
  const auto camera = open_simulated(simulator);
  const Outcome outcome = outcome_of([&] { camera->start({0.01, 1}); });
  EXPECT_EQ(outcome.kind, Kind::kTimeout) << outcome.what;
  // Setting it, and giving the settings back, wait for kPatience each; the kernel would have waited 5 s for each
  // control.
  EXPECT_LT(outcome.time, 3 * v4l2::Device::kPatience);
}

TEST(V4l2, AControlThatIsRefusedSaysSo) {
  const Simulator simulator({"--refuse-exposure"});
  const auto camera = open_simulated(simulator);
  const Outcome outcome = outcome_of([&] { camera->start({0.01, 1}); });
  EXPECT_EQ(outcome.kind, Kind::kBusy) << outcome.what;
  EXPECT_LT(outcome.time, v4l2::Device::kPatience + 1s);
}

TEST(V4l2, ASecondUserIsTurnedAway) {
  const Simulator simulator;
  const auto first = open_simulated(simulator), second = open_simulated(simulator);
  first->start({0.01, 1});
  const Outcome outcome = outcome_of([&] { second->start({0.01, 1}); });
  EXPECT_EQ(outcome.kind, Kind::kBusy) << outcome.what;
  EXPECT_NO_THROW(first->next_frame(Clock::now() + 3s));
}

TEST(V4l2, WithoutManualExposureThereIsNoBracket) {
  const Simulator simulator({"--no-manual-exposure"});
  const auto camera = open_simulated(simulator);
  EXPECT_FALSE(camera->capabilities().manual_exposure);
  EXPECT_EQ(outcome_of([&] { camera->start({0.01, 1}); }).kind, Kind::kNotSupported);
}

TEST(V4l2, WithoutPermissionItSaysSo) {
  const Simulator simulator;
  constexpr uid_t kNobody = 65534;
  ASSERT_EQ(seteuid(kNobody), 0);
  const Outcome outcome = outcome_of([&] { open_simulated(simulator); });
  ASSERT_EQ(seteuid(0), 0);
  EXPECT_EQ(outcome.kind, Kind::kPermission) << outcome.what;
}

TEST(V4l2, NoSuchDevice) {
  EXPECT_EQ(outcome_of([] { open_camera("v4l2:/dev/video77"); }).kind, Kind::kNotSupported);
  EXPECT_EQ(outcome_of([] { open_camera("v4l2:/dev/null"); }).kind, Kind::kNotSupported);
}

TEST(V4l2, CallsOutOfOrder) {
  const Simulator simulator;
  const auto camera = open_simulated(simulator);
  EXPECT_EQ(outcome_of([&] { camera->set({}); }).kind, Kind::kWrongState);
  EXPECT_EQ(outcome_of([&] { camera->next_frame(Clock::now()); }).kind, Kind::kWrongState);
  camera->start({0.01, 1});
  EXPECT_EQ(outcome_of([&] { camera->start({0.01, 1}); }).kind, Kind::kWrongState);
  EXPECT_EQ(outcome_of([&] { camera->configure({}); }).kind, Kind::kWrongState);
}

TEST(V4l2, DmabufIsTheSameMemory) {
  const Simulator simulator;
  const auto camera = open_simulated(simulator);
  camera->configure({.dmabuf = true});
  camera->start({0.01, 1});
  Frame frame = camera->next_frame(Clock::now() + 3s);
  ASSERT_GE(frame.dmabuf, 0);
  EXPECT_GE(lseek(frame.dmabuf, 0, SEEK_END), static_cast<off_t>(frame.bytes.size()));
  const std::vector<std::uint8_t> before(frame.bytes.begin(), frame.bytes.end());
  frame.detach();
  EXPECT_TRUE(std::ranges::equal(before, frame.bytes));
}

TEST(V4l2, HeldFramesOutliveTheStreamAndExhaustIt) {
  const Simulator simulator;
  const auto camera = open_simulated(simulator);
  camera->start({0.01, 1});
  std::vector<Frame> held;
  const Outcome outcome = outcome_of([&] {
    while (held.size() < 40) held.push_back(camera->next_frame(Clock::now() + 1s));
  });
  EXPECT_TRUE(outcome.kind == Kind::kWrongState || outcome.kind == Kind::kTimeout) << outcome.what;
  camera->stop();
  EXPECT_GT(held.back().bytes[0], 0);
  held.clear();
  camera->start({0.01, 1});
  EXPECT_NO_THROW(camera->next_frame(Clock::now() + 3s));
}

TEST(V4l2, SettingsAreGivenBackAtTheEnd) {
  const Simulator simulator;
  const auto before = simulator.settings();
  const auto camera = open_simulated(simulator);
  camera->start({0.01, 4});
  EXPECT_NE(simulator.settings(), before);
  camera->stop();
  EXPECT_EQ(simulator.settings(), before);
}

TEST(V4l2, SettingsAreGivenBackOnASignal) {
  const Simulator simulator;
  const auto before = simulator.settings();
  const pid_t child = fork();
  if (child == 0) {
    const auto camera = open_simulated(simulator);
    camera->start({0.01, 4});
    camera->next_frame(Clock::now() + 3s);
    kill(getpid(), SIGTERM);
    std::this_thread::sleep_for(10s);
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM) << status;
  EXPECT_EQ(simulator.settings(), before);
}

}  // namespace
}  // namespace hdr::test
