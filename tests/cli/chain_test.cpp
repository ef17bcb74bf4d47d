// The main job through the command, on a small world: photographs -> probe -> harmonics -> render, with the contract's
// keys.
#include "libhdr/io/read.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

class Chain : public ::testing::Test {
 protected:
  void SetUp() override { write_world(world()); }
  std::string world() const { return (scratch_ / "world.exr").string(); }
  std::string at(const std::string& name) const { return (scratch_ / name).string(); }
  /// Eight shots of a ball: seven 2 EV apart and one off that grid.
  Json shoot_ball(const std::string& folder, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"simulate", world(),   "-o",
                                          at(folder), "--ball",  "--size",
                                          "400x300",  "--times", "1/4000,1/1000,1/250,1/60,1/40,1/15,1/4,1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return answer_of(arguments);
  }

  ScratchDir scratch_;
};

TEST_F(Chain, SimulateWritesShotsWithExifAndTheTruth) {
  const Json answer = shoot_ball("shots", {"--response", "film", "--shift", "2"});
  ASSERT_EQ(answer["frames"].size(), 8u);
  const Json truth = Json::parse(bytes_of(scratch_ / "shots" / "bracket.json"));
  for (const char* key : {"files", "times_true", "times_nominal", "g", "k", "transforms", "ball"}) {
    EXPECT_TRUE(truth.contains(key)) << key;
  }
  ASSERT_EQ(truth["g"].size(), 3u);
  EXPECT_EQ(truth["g"][0].size(), 256u);
  EXPECT_NEAR(truth["ball"]["cx"].get<double>(), 200, 1e-9);
  for (std::size_t k = 0; k < 8; ++k) {
    const PhotoHeader header = read_photo_header(scratch_ / "shots" / truth["files"][k].get<std::string>());
    EXPECT_NEAR(*header.exposure.seconds / truth["times_true"][k].get<double>(), 1, 1e-4);
    EXPECT_TRUE(header.exposure.f_number && header.exposure.iso);
  }
}

TEST_F(Chain, ProbeIsTheWorldUpToAScaleAChannel) {
  shoot_ball("shots", {"--shift", "2"});
  const Json answer = answer_of({"probe", at("shots"), "-o", at("probe.exr"), "--width", "256"});
  for (const char* key : {"rms_log_error", "converged", "exposures", "reference", "frames", "width", "height",
                          "clipped", "dark", "stops", "ball", "views", "stages"}) {
    EXPECT_TRUE(answer.contains(key)) << key;
  }
  EXPECT_NEAR(answer["ball"]["cx"].get<double>(), 200, 3.5) << "within the hand shake";
  EXPECT_NEAR(answer["ball"]["r"].get<double>(), 120, 1);
  const Json diff = answer_of({"diff", at("probe.exr"), world(), "--scale", "channel", "--ignore-cones", "15"});
  EXPECT_LE(diff["median_abs_log2"].get<double>(), 0.08);
  EXPECT_EQ(diff["nonfinite"], Json::parse("[0,0]"));
}

TEST_F(Chain, TheSameBytesForAnyThreadCountAndOrderOfFiles) {
  const Json shots = shoot_ball("shots", {"--shift", "2"});
  std::vector<std::string> forward = {"probe"}, backward = {"probe"};
  for (const Json& frame : shots["frames"]) forward.push_back(frame["path"]);
  for (std::size_t k = shots["frames"].size(); k-- > 0;) backward.push_back(shots["frames"][k]["path"]);
  for (auto* arguments : {&forward, &backward}) arguments->insert(arguments->end(), {"--width", "128", "-o"});
  forward.insert(forward.end(), {at("one.exr"), "--threads", "1"});
  backward.insert(backward.end(), {at("two.exr"), "--threads", "2"});
  answer_of(forward);
  answer_of(backward);
  EXPECT_EQ(bytes_of(scratch_ / "one.exr"), bytes_of(scratch_ / "two.exr"));
  for (const char* threads : {"1", "2"}) {
    answer_of({"render", "--probe", at("one.exr"), "-o", at(std::string("r") + threads + ".exr"), "--size", "80x60",
               "--samples", "8", "--threads", threads});
  }
  EXPECT_EQ(bytes_of(scratch_ / "r1.exr"), bytes_of(scratch_ / "r2.exr"));
}

TEST_F(Chain, CalibrateWritesAResponseThatMergeTakes) {
  shoot_ball("shots");
  const Json calibrated = answer_of({"calibrate", at("shots"), "-o", at("r.json")});
  EXPECT_TRUE(calibrated["converged"].get<bool>());
  EXPECT_EQ(calibrated["exposures"].size(), 8u);
  const Json response = Json::parse(bytes_of(scratch_ / "r.json"));
  EXPECT_EQ(response["format"], "hdr-response");
  EXPECT_EQ(response["levels"], 256);
  for (const char* channel : {"R", "G", "B"}) {
    ASSERT_EQ(response["g"][channel].size(), 256u);
    EXPECT_EQ(response["g"][channel][128].get<double>(), 0.0);
  }
  const Json merged =
      answer_of({"merge", at("shots"), "-o", at("m.exr"), "--response", at("r.json"), "--align", "none"});
  EXPECT_EQ(merged["width"], 400);
  EXPECT_EQ(merged["frames"].size(), 8u);
  bool said = false;
  for (const Json& stage : merged["stages"]) said |= stage["name"] == "calibrate" && stage.contains("skipped");
  EXPECT_TRUE(said) << "a skipped stage must say so";
}

TEST_F(Chain, AlignFindsTheHandShake) {
  shoot_ball("shots", {"--shift", "4", "--format", "png"});
  const Json truth = Json::parse(bytes_of(scratch_ / "shots" / "bracket.json"));
  const Json answer = answer_of({"align", at("shots"), "-o", at("registered")});
  ASSERT_EQ(answer["frames"].size(), 8u);
  std::size_t reference = 8;
  for (std::size_t k = 0; k < 8; ++k) {
    if (answer["frames"][k]["path"] == answer["reference"]) reference = k;
  }
  ASSERT_LT(reference, 8u);
  int measured = 0;
  for (std::size_t k = 0; k < 8; ++k) {
    const Json& frame = answer["frames"][k];
    ASSERT_EQ(frame["ref_from_photo"].size(), 9u);
    if (frame.contains("skipped")) continue;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double expected =
          truth["transforms"][k][axis][2].get<double>() - truth["transforms"][reference][axis][2].get<double>();
      EXPECT_NEAR(frame["ref_from_photo"][3 * axis + 2].get<double>(), expected, 0.25)
          << frame["path"] << " (residual_px " << frame["residual_px"] << ")";
    }
    ++measured;
  }
  EXPECT_GE(measured, 4);
  EXPECT_TRUE(std::filesystem::exists(scratch_ / "registered" / "shot_03.png"));
}

TEST_F(Chain, UnwrapGoesThereAndBack) {
  answer_of({"unwrap", world(), "-o", at("angular.exr"), "--to", "angular", "--width", "512"});
  const Json back = answer_of({"unwrap", at("angular.exr"), "-o", at("back.exr"), "--width", "256"});
  EXPECT_EQ(back["views"][0]["probe_from_view"].size(), 9u);
  const Json diff = answer_of({"diff", at("back.exr"), world()});
  EXPECT_LE(diff["median_abs_log2"].get<double>(), 0.02);
  // Turning +Z to +X moves what stood in the centre to a quarter of the width, left of it.
  answer_of({"unwrap", world(), "-o", at("turned.exr"), "--width", "256", "--rotate", "0,90,0"});
  const RadianceMap turned = read_map(scratch_ / "turned.exr").map, still = read_map(world()).map;
  EXPECT_NEAR(turned.rgb(64, 40, 1), still.rgb(128, 40, 1), 1e-3 * still.rgb(128, 40, 1));
}

TEST_F(Chain, ARectilinearTagKeepsItsFieldUnlessFovSaysOtherwise) {
  answer_of({"unwrap", world(), "-o", at("view.exr"), "--to", "rectilinear", "--fov", "60", "--width", "200", "--type",
             "float"});
  answer_of({"unwrap", at("view.exr"), "-o", at("back.exr"), "--width", "256"});
  const RadianceMap back = read_map(scratch_ / "back.exr").map, still = read_map(world()).map;
  EXPECT_NEAR(back.rgb(140, 60, 1), still.rgb(140, 60, 1), 0.05 * still.rgb(140, 60, 1));
  EXPECT_EQ(back.rgb(128 + 26, 64, 1), 0) << "36 degrees off the axis a view of 60 shows nothing";
}

TEST_F(Chain, ShOfAConstantProbeIsPiL) {
  RadianceMap constant;
  constant.rgb = Image<float>(64, 32, 3);
  for (int y = 0; y < 32; ++y) std::fill(constant.rgb.row(y), constant.rgb.row(y) + 192, 0.5f);
  write_map(scratch_ / "constant.exr", constant);
  const Json answer = answer_of({"sh", at("constant.exr"), "-o", at("sh.json")});
  EXPECT_EQ(answer["degree"], 2);
  ASSERT_EQ(answer["coefficients"].size(), 9u);
  EXPECT_NEAR(answer["coefficients"][0][0].get<double>(), 0.5 * std::sqrt(4 * kPi), 1e-6);
  for (std::size_t k = 1; k < 9; ++k) EXPECT_NEAR(answer["coefficients"][k][1].get<double>(), 0, 1e-6) << k;
  // E = (n,1)^T M (n,1) = pi L whatever n.
  const Json m = answer["irradiance_matrix"]["G"];
  ASSERT_EQ(m.size(), 16u);
  EXPECT_NEAR(m[15].get<double>() + m[5].get<double>() + 2 * m[7].get<double>(), kPi * 0.5, 1e-6);
  EXPECT_GE(answer["error_bound"].get<double>(), 0);
  EXPECT_EQ(Json::parse(bytes_of(scratch_ / "sh.json"))["coefficients"], answer["coefficients"]);
}

TEST_F(Chain, RenderHasTheContractsKeys) {
  const Json answer = answer_of({"render", "--probe", world(), "-o", at("r.exr"), "--size", "64x48", "--samples", "4"});
  for (const char* key : {"seconds", "cpu_seconds", "rays", "samples_per_pixel", "estimated_error"}) {
    EXPECT_TRUE(answer.contains(key)) << key;
  }
  const RadianceMap picture = read_map(scratch_ / "r.exr").map;
  EXPECT_EQ(picture.size(), (Size{64, 48}));
  EXPECT_FALSE(picture.alpha.empty()) << "alpha is coverage";
}

TEST_F(Chain, AFolderFromShootIsShots) {
  answer_of({"simulate", world(), "-o", at("ball"), "--ball", "--size", "400x300", "--times", "1/60"});
  const Json answer = answer_of({"shoot", "--camera", "virtual:" + at("ball/truth.exr"), "--times",
                                 "1/1000,1/250,1/60,1/40,1/15,1/4", "-o", at("shots")});
  ASSERT_EQ(answer["frames"].size(), 6u);
  EXPECT_EQ(answer["frames"][1]["verified"], "metadata");
  EXPECT_TRUE(answer.contains("plan"));
  const Json probe = answer_of({"probe", at("shots"), "-o", at("probe.exr"), "--width", "128"});
  EXPECT_NEAR(probe["ball"]["r"].get<double>(), 120, 1);
}

TEST_F(Chain, ProvenanceNamesWorkNotPlaces) {
  shoot_ball("shots");
  answer_of({"calibrate", at("shots"), "-o", at("r.json")});
  answer_of(
      {"merge", at("shots"), "-o", at("m.exr"), "--weight", "hat", "--align", "none", "--response", at("r.json")});
  const CommandResult listed = run_command({"oiiotool", "--info", "-v", at("m.exr")});
  if (listed.exit_code == 127) GTEST_SKIP() << "oiiotool is not installed";
  for (const char* word : {"hdr:version", "hdr:options", "--weight hat", "--response r.json", "hdr:input",
                           "shot_00.jpg", "hdr:exposures", "chromaticities"}) {
    EXPECT_NE(listed.out.find(word), std::string::npos) << word << " in\n" << listed.out;
  }
  const std::string file = bytes_of(scratch_ / "m.exr");
  EXPECT_EQ(file.find(scratch_.path().string()), std::string::npos) << "folders stay out of the file";
}

TEST_F(Chain, InfoReadsEveryPixel) {
  RadianceMap map;
  map.rgb = Image<float>(4, 2, 3);
  for (int x = 0; x < 12; ++x) map.rgb.row(0)[x] = 1, map.rgb.row(1)[x] = 4;
  map.rgb(2, 1, 0) = std::nanf("");
  map.rgb(3, 1, 0) = -1;
  write_map(scratch_ / "odd.exr", map, {}, {SampleType::kFloat, "zip"});
  const Json row = answer_of({"info", at("odd.exr")})["files"][0];
  EXPECT_EQ(row["width"], 4);
  EXPECT_EQ(row["channels"], 3);
  EXPECT_EQ(row["nan"], 1);
  EXPECT_EQ(row["negative"], 1);
  EXPECT_EQ(row["max"], 4.0);
  EXPECT_EQ(row["stops"], 2.0);
}

}  // namespace
}  // namespace hdr::test
