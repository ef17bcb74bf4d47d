// Brackets from a camera, as files: a folder from shoot is SHOTS, and a shot that fails leaves nothing behind.
#include <set>

#include "libhdr/io/read.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

namespace fs = std::filesystem;

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

class Shoot : public ::testing::Test {
 protected:
  Shoot() { write_world(scene(), 128); }
  std::string scene() const { return path("world.exr"); }
  std::string path(const std::string& name) const { return (scratch_ / name).string(); }
  std::string camera(const std::string& options) const { return "virtual:" + scene() + "?" + options; }

 private:
  ScratchDir scratch_;
};

TEST_F(Shoot, WhatCameraAndFormatEverTheFolderMergesToTheScene) {
  struct Case {
    const char *options, *extension;
    double median;  ///< log2, against the light that was there: mostly the noise of single pixels, as shots are few
  };
  for (const Case& c :
       {Case{"format=rgb8", ".png", 0.025}, Case{"format=rgb16&response=gamma:2.2", ".png", 0.06},
        Case{"format=yuyv&metadata=0", ".png", 0.04}, Case{"format=mjpeg&latency=4", ".jpg", 0.05},
        Case{"format=bayer12&metadata=0", ".dng", 0.04}, Case{"format=bayer10p&cfa=gbrg", ".dng", 0.04}}) {
    fs::remove_all(path("shots"));
    const Json answer = answer_of({"shoot", "--camera", camera(c.options), "-o", path("shots")});
    ASSERT_GE(answer["frames"].size(), 2u) << c.options;
    EXPECT_EQ(answer["plan"]["times"].size(), answer["frames"].size()) << c.options;
    for (const Json& frame : answer["frames"]) {
      const fs::path file = frame["path"].get<std::string>();
      EXPECT_EQ(file.extension(), c.extension) << c.options;
      EXPECT_TRUE(fs::exists(file)) << file;
      EXPECT_NE(frame["verified"], "none") << "no frame with an unverified exposure is kept";
      EXPECT_NEAR(read_photo_header(file).exposure.seconds.value_or(0), frame["seconds"],
                  1e-6 * frame["seconds"].get<double>());
      EXPECT_TRUE(frame["requested_seconds"].is_number() && frame["sequence"].is_number());
    }
    answer_of({"merge", path("shots"), "-o", path("map.exr"), "--type", "float"});
    const Json diff = answer_of({"diff", path("map.exr"), scene(), "--scale", "channel"});
    EXPECT_LT(diff["median_abs_log2"].get<double>(), c.median) << c.options;
  }
}

// Shots of a raw bracket lie so far apart that no response could be fitted, and hardly share a usable pixel.
TEST_F(Shoot, RawShotsFarApartAreMergedWhereTheyLie) {
  for (const char* format : {"bayer10p", "bayer12"}) {
    answer_of({"shoot", "--camera", std::string("virtual:?format=") + format, "--raw", "-o", path(format)});
    for (const Json& frame : answer_of({"align", path(format)})["frames"]) {
      const Json& moved = frame["ref_from_photo"];
      EXPECT_LT(std::hypot(moved[2].get<double>(), moved[5].get<double>()), 0.1)
          << format << ": the camera did not move; " << frame.dump();
    }
  }
}

TEST_F(Shoot, RawFoldersSayThatTheyAreLinear) {
  answer_of(
      {"shoot", "--camera", camera("format=bayer12"), "--raw", "--stops", "2", "--count", "4", "-o", path("raw")});
  const Json bracket = Json::parse(bytes_of(path("raw/bracket.json")));
  EXPECT_EQ(bracket["response"], "linear");
  const auto skipped = [&](const Json& answer) {
    for (const Json& stage : answer["stages"]) {
      if (stage["name"] == "calibrate") return stage.value("skipped", std::string());
    }
    return std::string("no such stage");
  };
  EXPECT_NE(skipped(answer_of({"merge", path("raw"), "-o", path("a.exr")})).find("linear"), std::string::npos);
  EXPECT_EQ(skipped(answer_of({"merge", path("raw"), "-o", path("b.exr"), "--response", "fit"})), "");
  fs::create_directory(path("copied"));
  for (const Json& name : bracket["files"]) {
    fs::copy(path("raw/" + name.get<std::string>()), path("copied/" + name.get<std::string>()));
  }
  EXPECT_EQ(skipped(answer_of({"merge", path("copied"), "-o", path("c.exr")})), "") << "nobody says so any more";
  answer_of({"shoot", "--camera", camera("format=bayer12"), "--format", "png", "-o", path("png")});
  EXPECT_NE(skipped(answer_of({"merge", path("png"), "-o", path("d.exr")})).find("linear"), std::string::npos);
  answer_of({"shoot", "--camera", camera("format=rgb8"), "--response", "srgb", "-o", path("known")});
  EXPECT_NE(skipped(answer_of({"merge", path("known"), "-o", path("e.exr")})).find("srgb"), std::string::npos);
}

TEST_F(Shoot, AsksForTheTimesThatAreGiven) {
  const Json answer =
      answer_of({"shoot", "--camera", camera("format=rgb8"), "--times", "1/250,1/60,1/15", "-o", path("shots")});
  ASSERT_EQ(answer["frames"].size(), 3u);
  EXPECT_NEAR(answer["frames"][1]["seconds"].get<double>(), 1.0 / 60, 1e-9);
  const Json lamps = answer_of({"shoot", "--camera", camera("format=rgb8"), "--stops", "1.3", "--count", "5", "--mains",
                                "50", "-o", path("lamps")});
  int longer = 0;
  for (const Json& frame : lamps["frames"]) {
    const double periods = frame["seconds"].get<double>() / 0.01;
    if (periods < 1) continue;  // shorter than one period: nothing helps
    ++longer;
    EXPECT_NEAR(periods, std::round(periods), 1e-6) << "a multiple of 10 ms";
  }
  EXPECT_GE(longer, 2);
}

TEST_F(Shoot, AFailureLeavesNothingBehind) {
  const auto refused = [&](const std::string& options, const std::string& word, std::vector<std::string> more = {}) {
    std::vector<std::string> line = {"shoot", "--camera", camera(options), "-o", path("deep/er/shots")};
    line.insert(line.end(), more.begin(), more.end());
    expect_refusal(line, {word});
    EXPECT_FALSE(fs::exists(path("deep"))) << options << " left something";
  };
  refused("faults=unplug:3", "gone");
  refused("faults=freeze:3", "world.exr");
  refused("faults=stall:2", "world.exr");
  refused("faults=busy", "world.exr");
  refused("faults=permission", "world.exr");
  refused("faults=no-manual", "world.exr");
  refused("format=rgb8", "raw", {"--raw"});
  refused("format=rgb8", "raw", {"--format", "dng"});
  refused("format=rgb16", "8 bits", {"--format", "jpg"});
  refused("format=rgb8", "--deadline", {"--deadline", "0.05"});
  expect_refusal({"shoot", "--camera", "firewire:0", "-o", path("deep")}, {"firewire:0", "virtual:"});
}

TEST_F(Shoot, EarlierShotsStayWhenALaterRunFails) {
  answer_of({"shoot", "--camera", camera("format=rgb8"), "--times", "1/250,1/60,1/15,1/4", "-o", path("shots")});
  const std::set<std::string> before = names_in(path("shots"));
  expect_refusal({"shoot", "--camera", camera("faults=unplug:3"), "-o", path("shots")}, {"gone"});
  EXPECT_EQ(names_in(path("shots")), before);
  answer_of(
      {"shoot", "--camera", camera("format=rgb8"), "--times", "1/60,1/15", "--format", "tif", "-o", path("shots/")});
  EXPECT_EQ(names_in(path("shots")), (std::set<std::string>{"bracket.json", "shot_00.tif", "shot_01.tif"}))
      << "the folder is SHOTS: two brackets in it would be merged";
}

TEST_F(Shoot, CtrlCGivesTheCameraBackAndLeavesNothing) {
  // Shots of seconds, in real time. --foreground: one signal, as a terminal sends; without it timeout sends two, and
  // the second ends the command at once.
  const CommandResult result =
      run_command({"timeout", "--foreground", "--preserve-status", "-s", "INT", "2", HDR_BINARY, "shoot", "--camera",
                   camera("format=rgb8&realtime=1"), "--times", "4,5,6,7", "-o", path("shots")});
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_NE(result.err.find("stopped"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(path("shots")));
}

TEST_F(Shoot, ALineOfTheTerminalShowsWhatTheCameraSees) {
  if (run_command({"sh", "-c", "command -v script"}).exit_code != 0) GTEST_SKIP() << "script(1) makes the terminal";
  const std::string line = std::string(HDR_BINARY) + " shoot --camera '" + camera("format=bayer10p") +
                           "' --preview 1 -o '" + path("shots") + "'";
  const CommandResult result = run_command({"script", "-qec", line, "/dev/null"});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  EXPECT_NE(result.out.find("█"), std::string::npos);
  EXPECT_NE(result.out.find("clipped"), std::string::npos);
  EXPECT_NE(result.out.find("1/60 s"), std::string::npos);
  EXPECT_TRUE(fs::exists(path("shots/bracket.json")));
  const CommandResult piped = run_hdr({"shoot", "--camera", camera("format=rgb8"), "-o", path("piped")});
  EXPECT_EQ(piped.err.find("clipped"), std::string::npos) << "a live view in a log file:\n" << piped.err;
}

TEST_F(Shoot, ContradictionsAreMisuse) {
  const std::string where = path("shots");
  EXPECT_EQ(run_hdr({"shoot", "--times", "1/60", "--auto", "-o", where}).exit_code, 2);
  EXPECT_EQ(run_hdr({"shoot", "--stops", "2", "-o", where}).exit_code, 2);
  EXPECT_EQ(run_hdr({"shoot", "--mains", "55", "-o", where}).exit_code, 2);
  EXPECT_EQ(run_hdr({"shoot"}).exit_code, 2) << "no -o";
}

TEST(Cameras, EachSaysWhatItCan) {
  const Json answer = answer_of({"cameras"});
  ASSERT_GE(answer["cameras"].size(), 1u);
  for (const Json& camera : answer["cameras"]) {
    EXPECT_TRUE(camera["uri"].is_string() && camera["name"].is_string()) << camera;
    if (camera.contains("error")) continue;  // connected, and busy or forbidden
    EXPECT_GE(camera["formats"].size(), 1u);
    EXPECT_LT(camera["exposure_seconds"][0].get<double>(), camera["exposure_seconds"][1].get<double>());
  }
  EXPECT_EQ(answer["cameras"].back()["uri"], "virtual:") << "works on any machine";
}

}  // namespace
}  // namespace hdr::test
