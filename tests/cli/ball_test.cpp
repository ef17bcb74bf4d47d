// Mirror balls through the command: beside the camera's axis, with their reflectance.
#include "libhdr/io/read.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

class Ball : public ::testing::Test {
 protected:
  void SetUp() override { write_world(world()); }
  std::string world() const { return at("world.exr"); }
  std::string at(const std::string& name) const { return (scratch_ / name).string(); }
  /// The picture behind a simulated photograph of a ball, and the truth about it.
  Json photograph(const std::string& folder, std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"simulate", world(),   "-o",   at(folder), "--ball", "--size",
                                          "600x450",  "--times", "1/60", "--format", "png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    answer_of(arguments);
    return Json::parse(bytes_of(scratch_ / folder / "bracket.json"))["ball"];
  }
  double p99_from_world(const std::string& probe) const {
    return answer_of({"diff", at(probe), world(), "--ignore-cones", "35"})["p99_abs_log2"];
  }
  double median_from_world(const std::string& probe) const {
    return answer_of({"diff", at(probe), world(), "--ignore-cones", "35"})["median_abs_log2"];
  }

  ScratchDir scratch_;
};

TEST_F(Ball, BesideTheMiddleTheCamerasFieldGivesTheTrueRays) {
  const Json ball = photograph("shots", {"--distance", "6", "--ball-at", "180,160", "--ball-radius", "110"});
  const std::string outline = std::to_string(ball["cx"].get<double>()) + "," +
                              std::to_string(ball["cy"].get<double>()) + "," + std::to_string(ball["r"].get<double>());
  // A map without a tag, as a merge writes it.
  answer_of({"unwrap", at("shots/truth.exr"), "-o", at("tagged.exr"), "--width", "256"});
  const Json answer = answer_of({"unwrap", at("shots/truth.exr"), "-o", at("probe.exr"), "--width", "256", "--ball",
                                 outline, "--camera-fov", std::to_string(ball["fov"].get<double>())});
  EXPECT_NEAR(answer["ball"]["distance"].get<double>(), 6, 1e-3);
  EXPECT_LT(median_from_world("tagged.exr"), 0.05);
  EXPECT_LT(median_from_world("probe.exr"), 0.05);
  answer_of({"unwrap", at("shots/truth.exr"), "-o", at("far.exr"), "--width", "256", "--from",
             "mirror-ball cx=180 cy=160 r=110"});
  EXPECT_GT(p99_from_world("far.exr"), 1.3 * p99_from_world("probe.exr")) << "a far camera's rays are others";
}

TEST_F(Ball, WhatOnlyABallHasNeedsNoFrom) {
  photograph("shots", {"--ball-at", "300,225", "--ball-radius", "180"});
  const std::string shot = at("shots/shot_00.png");
  const auto unwrapped = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"unwrap", shot, "-o", at(name), "--width", "128"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    answer_of(arguments);
    return read_map(at(name)).map.rgb.clone();
  };
  const Image<float> said = unwrapped("said.exr", {"--from", "mirror-ball", "--ball", "300,225,180"});
  const Image<float> implied = unwrapped("implied.exr", {"--ball", "300,225,180"});
  const Image<float> circle = unwrapped("circle.exr", {"--circle", "300,225,180"});
  int same = 0, as_fisheye = 0;
  for (int y = 0; y < said.height(); ++y) {
    for (std::size_t k = 0; k < said.row_samples(); ++k) {
      same += said.row(y)[k] == implied.row(y)[k];
      as_fisheye += said.row(y)[k] == circle.row(y)[k];
    }
  }
  EXPECT_EQ(same, 128 * 64 * 3);
  EXPECT_LT(as_fisheye, 64 * 64 * 3) << "an image circle is a fisheye's";
  EXPECT_EQ(run_hdr({"unwrap", shot, "-o", at("no.exr")}).exit_code, 1) << "nothing says what this 600x450 picture is";
}

/// Puts FocalLengthIn35mmFilm in the place of the ISO among a JPEG's EXIF, and says no other focal length.
void set_focal_length(const std::filesystem::path& photo, int millimetres) {
  std::string bytes = bytes_of(photo);
  const std::string iso("\x27\x88\x03\0\x01\0\0\0", 8), focal("\x05\xa4\x03\0\x01\0\0\0", 8);
  const std::size_t at = std::min(bytes.find(iso), bytes.find(focal));
  ASSERT_NE(at, std::string::npos) << photo;
  bytes.replace(at, 8, focal);
  bytes[at + 8] = static_cast<char>(millimetres & 0xff);
  bytes[at + 9] = static_cast<char>(millimetres >> 8);
  const std::string focal_length("\x0a\x92\x05\0\x01\0\0\0", 8);
  if (const auto found = bytes.find(focal_length); found != std::string::npos) bytes[found + 1] = '\x91';
  std::ofstream(photo, std::ios::binary) << bytes;
}

TEST_F(Ball, ExifsFieldGivesTheDistanceToWholeFramesAlone) {
  const auto shoot = [&](const std::string& folder, const std::string& size) {
    answer_of({"simulate", world(), "-o", at(folder), "--ball", "--size", size, "--times", "1/60", "--format", "jpg",
               "--distance", "6", "--ball-radius", "150"});
    const Json ball = Json::parse(bytes_of(scratch_ / folder / "bracket.json"))["ball"];
    set_focal_length(scratch_ / folder / "shot_00.jpg", 0);
    return ball;
  };
  const auto unwrapped = [&](const std::string& folder, const std::string& outline,
                             std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {
        "unwrap", at(folder + "/shot_00.jpg"), "-o", at("x.exr"), "--from", "mirror-ball", "--width", "128", "--ball",
        outline};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return answer_of(arguments);
  };
  const Json ball = shoot("whole", "600x450");
  EXPECT_TRUE(unwrapped("whole", "300,225,150")["ball"]["distance"].is_null()) << "0 millimetres: unknown";
  // The lens that gives 36 x 24 mm the same diagonal field; a whole number, as the tag holds.
  const double focal_px = 300 / std::tan(0.5 * ball["fov"].get<double>() * kDegree);
  const double millimetres = focal_px * std::hypot(36, 24) / std::hypot(600, 450);
  set_focal_length(scratch_ / "whole" / "shot_00.jpg", static_cast<int>(std::lround(millimetres)));
  const Json found = unwrapped("whole", "300,225,150");
  EXPECT_NEAR(1 / found["ball"]["distance"].get<double>(), 1.0 / 6, 0.3 * kDegree) << "what the rim's directions err";
  EXPECT_NEAR(found["camera_fov"].get<double>(), ball["fov"].get<double>(), 0.02 * ball["fov"].get<double>());
  EXPECT_EQ(unwrapped("whole", "300,225,150", {"--distance", "9"})["ball"]["distance"], 9.0) << "what is said counts";
  shoot("crop", "480x472");
  set_focal_length(scratch_ / "crop" / "shot_00.jpg", 28);
  EXPECT_TRUE(unwrapped("crop", "240,236,150")["ball"]["distance"].is_null()) << "a crop keeps the whole frame's tag";
}

TEST_F(Ball, ACamerasLensIsKnownToItsPhotographsAndToWhatIsMergedFromThem) {
  for (const std::string format : {"jpg", "png", "tif"}) {
    answer_of({"simulate", world(), "-o", at("shots"), "--ball", "--size", "500x420", "--times", "1/250,1/60,1/15",
               "--format", format, "--distance", "6", "--ball-radius", "150"});
    const auto distance_of = [&](const std::string& picture) {
      return answer_of({"unwrap", at(picture), "-o", at("x.exr"), "--from", "mirror-ball", "--width", "64", "--ball",
                        "250,210,150"})["ball"]["distance"];
    };
    EXPECT_NEAR(distance_of("shots/shot_01." + format).get<double>(), 6, 1e-3) << format;
    answer_of({"merge", at("shots"), "-o", at("map.exr"), "--align", "none"});
    EXPECT_NEAR(distance_of("map.exr").get<double>(), 6, 1e-3) << format;
  }
  answer_of({"simulate", world(), "-o", at("far"), "--ball", "--size", "500x420", "--times", "1/60"});
  EXPECT_TRUE(answer_of({"unwrap", at("far/shot_00.jpg"), "-o", at("x.exr"), "--from", "mirror-ball", "--width", "64",
                         "--ball", "250,210,168"})["ball"]["distance"]
                  .is_null())
      << "no lens sees a ball from infinitely far";
}

TEST_F(Ball, ReflectanceIsDividedOut) {
  photograph("shots", {"--reflectance", "0.5,0.55,0.6", "--distance", "20"});
  answer_of({"unwrap", at("shots/truth.exr"), "-o", at("dark.exr"), "--width", "256"});
  answer_of(
      {"unwrap", at("shots/truth.exr"), "-o", at("probe.exr"), "--width", "256", "--reflectance", "0.5,0.55,0.6"});
  EXPECT_GT(median_from_world("dark.exr"), 0.5);
  EXPECT_LT(median_from_world("probe.exr"), 0.05);
}

TEST_F(Ball, TwoViewsShowTheWholeSphereAndNobody) {
  photograph("one", {"--photographer", "8", "--distance", "12"});
  photograph("two", {"--photographer", "8", "--distance", "12", "--rotate", "0,90,0"});
  const std::vector<std::string> views = {at("one/truth.exr"), at("two/truth.exr")};
  const Json answer = answer_of({"unwrap", views[0], views[1], "-o", at("probe.exr"), "--width", "256"});
  ASSERT_EQ(answer["views"].size(), 2u);
  for (const char* key : {"from_path", "probe_from_view", "overlap_rms", "gain"}) {
    for (const Json& view : answer["views"]) EXPECT_TRUE(view.contains(key)) << key;
  }
  EXPECT_EQ(answer["views"][0]["probe_from_view"], Json::parse("[1,0,0,0,1,0,0,0,1]")) << "the first sets the axes";
  // The second scene was turned by 90 degrees about +Y, so its view turns back.
  const std::vector<double> expected = {0, 0, -1, 0, 1, 0, 1, 0, 0};
  for (std::size_t k = 0; k < 9; ++k)
    EXPECT_NEAR(answer["views"][1]["probe_from_view"][k].get<double>(), expected[k], 0.1 * kDegree) << "element " << k;
  EXPECT_NEAR(answer["views"][1]["gain"].get<double>(), 1, 0.01);
  const Json whole = answer_of({"diff", at("probe.exr"), world()});
  answer_of({"unwrap", views[0], "-o", at("one.exr"), "--width", "256"});
  const Json one = answer_of({"diff", at("one.exr"), world()});
  EXPECT_LT(whole["p99_abs_log2"].get<double>(), 1) << "no photographer and no blind spot";
  EXPECT_GT(one["p99_abs_log2"].get<double>(), whole["p99_abs_log2"].get<double>() + 0.4) << "both were there";
}

TEST_F(Ball, ViewsThatDoNotFitAreRefused) {
  photograph("one", {});
  write_world(at("other.exr"), 128);
  answer_of({"simulate", at("other.exr"), "-o", at("two"), "--fov", "60", "--size", "600x450", "--times", "1/60",
             "--format", "png"});
  const std::string one = at("one/truth.exr"), two = at("two/truth.exr");
  expect_refusal({"unwrap", one, two, "-o", at("x.exr"), "--from", "mirror-ball", "--ball", "300,225,180"},
                 {"truth.exr", "does not show what"});
  expect_refusal({"unwrap", one, one, "-o", at("x.exr"), "--mask", one}, {"--mask", "each"});
  expect_refusal({"unwrap", one, "-o", at("x.exr"), "--ball", "300,440,180"},
                 {"% of the ball", "photograph all of it"});
  expect_refusal({"unwrap", one, "-o", at("x.exr"), "--ball", "300,225,900"}, {"% of the ball", "--ball"});
  expect_refusal({"unwrap", two, "-o", at("x.exr"), "--from", "mirror-ball"}, {"no mirror ball found", "--ball"});
}

TEST_F(Ball, WhatCannotBeIsRefused) {
  photograph("shots", {"--photographer", "8"});
  const std::string truth = at("shots/truth.exr");
  expect_refusal({"unwrap", truth, "-o", at("x.exr"), "--reflectance", "0,1,1"}, {"--reflectance", "above 0"});
  expect_refusal({"unwrap", truth, "-o", at("x.exr"), "--camera-fov", "200"}, {"180"});
  expect_refusal({"unwrap", truth, "-o", at("x.exr"), "--distance", "0.9"}, {"--distance", "1 radius"});
  expect_refusal({"simulate", world(), "-o", at("y"), "--ball", "--times", "1/60", "--photographer", "50"},
                 {"--photographer", "40"});
  expect_refusal({"simulate", world(), "-o", at("y"), "--ball", "--times", "1/60", "--reflectance", "2,1,1"},
                 {"--reflectance"});
}

}  // namespace
}  // namespace hdr::test
