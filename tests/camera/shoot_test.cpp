// `hdr shoot` over the kernel's own drivers, by V4L2 and by libcamera. Runs in the virtual machine only.
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "libhdr/io/read.h"
#include "tests/camera/hdr_child.h"
#include "tests/camera/simulator.h"

namespace hdr::test {
namespace {

using Json = nlohmann::json;
using namespace std::chrono_literals;

constexpr uid_t kNobody = 65534;
const std::string kTimes = "1/1000,1/250,1/60,1/15,1/4";

/// Which way to the one camera that is plugged in.
class Shoot : public ::testing::TestWithParam<std::string> {
 protected:
  std::string camera(const Simulator& simulator) const {
    const std::string device = GetParam() == "v4l2" ? simulator.node() : "";
    return GetParam() + ":" + device + "?format=YUYV&size=320x240";
  }
  std::string folder() const { return scratch_ / "deep/shots"; }
  std::vector<std::string> line(const Simulator& simulator, const std::string& times = kTimes) const {
    return {"shoot", "--camera", camera(simulator), "--times", times, "--json", "-o", folder()};
  }

  /// bracket.json of a run that succeeds.
  Json shoot(const std::vector<std::string>& arguments) {
    HdrChild child(arguments);
    const CommandResult result = child.wait();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    if (result.exit_code != 0) return Json();
    answer_ = Json::parse(result.out);
    return Json::parse(std::ifstream(folder() + "/bracket.json"));
  }

  /// Exit code 1, one line with these words, nothing left behind, and all that within so many seconds.
  void expect_failure(HdrChild& child, const std::vector<std::string>& words, double seconds) {
    const CommandResult result = child.wait();
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_TRUE(std::ranges::any_of(words, [&](const std::string& word) {
      return result.err.find(word) != std::string::npos;
    })) << result.err;
    // A program that is started, not forked, loads for as long as the machine's load makes it.
    EXPECT_LT(child.seconds(), GetParam() == "v4l2" ? seconds : seconds + 60) << result.err;
    EXPECT_TRUE(std::filesystem::is_empty(scratch_.path())) << "something is left behind";
    std::cout << "  after " << child.seconds() << " s: " << result.err;
  }

  ScratchDir scratch_;
  Json answer_;
};

/// Faults that end above both ways alike, or of which libcamera tells nothing. Starting a program that has libcamera
/// takes seconds here.
class ShootByV4l2 : public Shoot {};

/// Every frame was really taken with the exposure that it says.
void expect_true_exposures(const Json& bracket, const Simulator& simulator) {
  const auto used = simulator.used();
  for (const Json& frame : bracket["frames"]) {
    EXPECT_NE(frame["verified"], "none");
    const auto truth = std::ranges::find_if(used, [&](const Simulator::Used& u) {
      return u.stream == used.back().stream && u.sequence == frame["sequence"].get<int>();
    });
    ASSERT_NE(truth, used.end()) << "the sensor knows no frame " << frame["sequence"];
    EXPECT_NEAR(frame["seconds"].get<double>(), truth->exposure_100us * 1e-4, 1e-6) << frame.dump();
  }
}

void wait_for_frames(const Simulator& simulator, std::size_t count) {
  for (int k = 0; k < 3000 && simulator.used().size() < count; ++k) std::this_thread::sleep_for(20ms);
  ASSERT_GE(simulator.used().size(), count);
}

TEST_P(Shoot, ABracketMergesToTheScene) {
  const Simulator simulator({"--noise", "--latency", "2"});
  const Json bracket = shoot({"shoot", "--camera", camera(simulator), "--auto", "--json", "-o", folder()});
  expect_true_exposures(bracket, simulator);
  HdrChild merge({"merge", folder(), "-o", scratch_ / "map.exr", "--align", "none"});
  const CommandResult merged = merge.wait();
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  const double error = asked_in_a_child([&] {
    const RadianceMap map = read_map(scratch_ / "map.exr").map;
    return median_error(map.rgb, simulated_scene(map.rgb.size()));
  });
  std::cout << "  " << bracket["files"].size() << " shots by " << GetParam() << ", merged: median error " << 100 * error
            << " %\n  " << answer_["device_seconds"] << '\n';
  EXPECT_LT(error, 0.02);
}

TEST_P(Shoot, EveryLatencyIsFoundOut) {
  const bool quick = GetParam() == "v4l2";
  for (const int latency : quick ? std::vector{0, 1, 2, 3, 4} : std::vector{4}) {
    const Simulator simulator({"--noise", "--latency", std::to_string(latency)});
    const Json bracket = shoot(line(simulator, "1/1000,1/100,1/10"));
    EXPECT_EQ(bracket["files"].size(), 3u) << "latency " << latency << answer_["warnings"];
    expect_true_exposures(bracket, simulator);
    std::filesystem::remove_all(scratch_ / "deep");
  }
}

TEST_P(ShootByV4l2, BadAndLostFramesAreSkipped) {
  const Simulator simulator({"--damage-every", "4", "--lose-every", "9", "--noise"});
  const Json bracket = shoot(line(simulator));
  EXPECT_EQ(bracket["files"].size(), 5u) << answer_["warnings"];
  expect_true_exposures(bracket, simulator);
}

TEST_P(Shoot, UnpluggedInMidBracket) {
  const Simulator simulator({"--unplug-at-frame", "14"});
  HdrChild child(line(simulator));
  expect_failure(child, {"gone"}, 15);
}

TEST_P(ShootByV4l2, FramesThatStopComing) {
  const Simulator simulator({"--freeze-at-frame", "14"});
  HdrChild child(line(simulator));
  expect_failure(child, {"no frame came in time"}, 30);
}

TEST_P(Shoot, AControlThatIsNeverAnswered) {
  const Simulator simulator({"--silent-exposure"});
  HdrChild child(line(simulator));
  // libcamera does not say that the camera does not answer: its frames stop.
  expect_failure(child, {"no answer", "no frame came in time"}, 30);
}

TEST_P(ShootByV4l2, AControlThatIsRefused) {
  const Simulator simulator({"--refuse-exposure"});
  HdrChild child(line(simulator));
  expect_failure(child, {"not ready"}, 30);
}

TEST_P(ShootByV4l2, WithoutManualExposure) {
  const Simulator simulator({"--no-manual-exposure"});
  HdrChild child(line(simulator));
  expect_failure(child, {"manual"}, 15);
}

TEST_P(Shoot, WithoutPermission) {
  const Simulator simulator;
  std::filesystem::permissions(scratch_.path(), std::filesystem::perms::all);
  HdrChild child(line(simulator), kNobody);
  expect_failure(child, {"group video"}, 15);
}

TEST_P(Shoot, WhileAnotherProgramHasTheCamera) {
  const Simulator simulator;
  HdrChild first({"shoot", "--camera", camera(simulator), "--preview", "600", "--quiet"});
  wait_for_frames(simulator, 3);
  HdrChild second(line(simulator));
  expect_failure(second, {"another program"}, 15);
  first.send(SIGTERM);
  EXPECT_EQ(first.wait().exit_code, 1);
}

TEST_P(Shoot, CtrlCGivesTheSettingsBack) {
  const Simulator simulator;
  const auto before = simulator.settings();
  HdrChild child(line(simulator, "1/1000,1/250,1/60,1/15,1/4,1/2,1"));
  wait_for_frames(simulator, 12);
  EXPECT_NE(simulator.settings(), before);
  child.send(SIGINT);
  expect_failure(child, {"stopped by a signal"}, 30);
  EXPECT_EQ(simulator.settings(), before);
}

std::string name_of(const ::testing::TestParamInfo<std::string>& info) {
  return info.param;
}
#ifdef HDR_HAS_LIBCAMERA
INSTANTIATE_TEST_SUITE_P(By, Shoot, ::testing::Values("v4l2", "libcamera"), name_of);
#else
INSTANTIATE_TEST_SUITE_P(By, Shoot, ::testing::Values("v4l2"), name_of);
#endif
INSTANTIATE_TEST_SUITE_P(By, ShootByV4l2, ::testing::Values("v4l2"), name_of);

#ifdef HDR_HAS_LIBCAMERA
TEST(Cameras, AreListedByBothWaysAndOpenByWhatTheyAreCalled) {
  const Simulator simulator;
  HdrChild cameras({"cameras", "--json"});
  const CommandResult result = cameras.wait();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::string by_libcamera;
  bool by_v4l2 = false;
  std::string uris;
  const Json answer = Json::parse(result.out);
  for (const Json& camera : answer["cameras"]) {
    const std::string uri = camera["uri"];
    uris += uri + "\n";
    by_v4l2 = by_v4l2 || uri == "v4l2:" + simulator.node();
    if (uri.starts_with("libcamera:")) by_libcamera = uri;
    EXPECT_FALSE(camera.contains("error")) << camera;
  }
  EXPECT_TRUE(by_v4l2) << uris;
  ASSERT_FALSE(by_libcamera.empty()) << uris;
  ScratchDir scratch;
  HdrChild shoot({"shoot", "--camera", by_libcamera + "?size=320x240&format=YUYV", "--times", "1/100", "-o",
                  scratch / "shots", "--json"});
  const CommandResult shot = shoot.wait();
  EXPECT_EQ(shot.exit_code, 0) << shot.err;
}
#endif

}  // namespace
}  // namespace hdr::test
