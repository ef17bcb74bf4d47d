// Bad input: a clear line that names the file, the fact and the remedy, or a stated, right result.
#include <limits>

#include "libhdr/io/read.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

class BadInput : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return (scratch_ / name).string(); }

  /// A photograph of a gradient, `stops` brighter than the first; exposure in EXIF when given.
  std::string photo(const std::string& name, double stops, std::optional<double> seconds, Size size = {48, 32}) const {
    Image<std::uint8_t> codes(size, 3);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width * 3; ++x) {
        const double level = std::exp2(8.0 * (x / 3) / size.width - 7 + stops + 0.1 * y / size.height);
        codes.row(y)[x] = static_cast<std::uint8_t>(std::lround(255 * std::pow(std::min(1.0, level), 1 / 2.2)));
      }
    }
    Photo photo;
    photo.exposure.seconds = seconds;
    photo.codes = std::move(codes);
    write_photo(scratch_ / name, photo);
    return at(name);
  }
  std::vector<std::string> bracket() const {
    return {photo("a.png", 0, 0.01), photo("b.png", 2, 0.04), photo("c.png", 4, 0.16)};
  }
  std::vector<std::string> merge_of(std::vector<std::string> shots, std::vector<std::string> more = {}) const {
    shots.insert(shots.begin(), "merge");
    shots.insert(shots.end(), {"-o", at("out.exr")});
    shots.insert(shots.end(), more.begin(), more.end());
    return shots;
  }

  ScratchDir scratch_;
};

TEST_F(BadInput, AGoodBracketPasses) {
  answer_of(merge_of(bracket()));
}

TEST_F(BadInput, NoExposureTime) {
  expect_refusal(merge_of({photo("a.png", 0, 0.01), photo("b.png", 2, std::nullopt)}),
                 {"b.png", "exposure time", "--times"});
}

TEST_F(BadInput, EqualTimes) {
  expect_refusal(merge_of({photo("a.png", 0, 0.01), photo("b.png", 2, 0.01)}), {"same exposure", "--times"});
}

TEST_F(BadInput, MixedSizes) {
  expect_refusal(merge_of({photo("a.png", 0, 0.01), photo("b.png", 2, 0.04, {24, 16})}), {"b.png", "24x16", "48x32"});
}

TEST_F(BadInput, OneShotNeedsAResponseAndThenIsRight) {
  const std::string shot = photo("a.png", 3, 0.01);
  expect_refusal(merge_of({shot}), {"--response"});
  const Json merged = answer_of(merge_of({shot}, {"--response", "gamma:2.2", "--type", "float"}));
  EXPECT_EQ(merged["frames"].size(), 1u);
  EXPECT_GT(merged["clipped"].get<int>(), 0) << "three stops over: some pixels clip, and that is said";
  // Radiance ratios follow the known curve where nothing clips: x/48 of 8 stops.
  const RadianceMap map = read_map(scratch_ / "out.exr").map;
  EXPECT_NEAR(std::log2(map.rgb(18, 0, 1) / map.rgb(6, 0, 1)), 2, 0.1);
}

TEST_F(BadInput, TruncatedJpeg) {
  photo("whole.jpg", 0, 0.01, {320, 240});
  const std::string whole = bytes_of(scratch_ / "whole.jpg");
  std::ofstream(scratch_ / "cut.jpg", std::ios::binary) << whole.substr(0, whole.size() / 2);
  expect_refusal(merge_of({photo("a.jpg", 2, 0.04, {320, 240}), at("cut.jpg")}), {"cut.jpg", "truncated"});
  const CommandResult info = run_hdr({"info", at("cut.jpg"), at("whole.jpg")});
  EXPECT_EQ(info.exit_code, 1);
  EXPECT_NE(info.out.find("whole.jpg"), std::string::npos) << "the others are still reported";
}

TEST_F(BadInput, EmptyFolderMissingFileAndTextNamedJpg) {
  std::filesystem::create_directory(scratch_ / "empty");
  expect_refusal(merge_of({at("empty")}), {"empty", "no photographs"});
  expect_refusal(merge_of({at("nowhere.jpg"), photo("a.png", 0, 0.01)}), {"nowhere.jpg"});
  std::ofstream(scratch_ / "letter.jpg") << "Dear photographer, this is not a photograph.\n";
  expect_refusal(merge_of({at("letter.jpg"), photo("a.png", 0, 0.01)}), {"letter.jpg", "JPEG"});
}

TEST_F(BadInput, UnwritableOutputLeavesNothing) {
  auto arguments = merge_of(bracket());
  for (std::string& a : arguments) {
    if (a == at("out.exr")) a = at("no/such/folder/out.exr");
  }
  expect_refusal(arguments, {"no/such/folder", "written"});
  for (std::string& a : arguments) {
    if (a == at("no/such/folder/out.exr")) a = at("folder.exr");
  }
  std::filesystem::create_directory(scratch_ / "folder.exr");
  expect_refusal(arguments, {"folder.exr", "written"});
  for (const auto& entry : std::filesystem::directory_iterator(scratch_.path())) {
    EXPECT_EQ(entry.path().filename().string().find(".tmp"), std::string::npos) << entry.path();
  }
}

TEST_F(BadInput, APictureOfOnePixel) {
  const std::vector<std::string> shots = {photo("a.png", 0, 0.01, {1, 1}), photo("b.png", 2, 0.04, {1, 1})};
  const Json merged = answer_of(merge_of(shots, {"--response", "gamma:2.2"}));
  EXPECT_EQ(merged["width"], 1);
  expect_refusal(merge_of(shots), {"response"});
}

TEST_F(BadInput, TimesThatAreNoTimes) {
  for (const char* times : {"nan,1,2", "0,1,2", "-1,1,2", "inf,1,2"}) {
    expect_refusal(merge_of(bracket(), {"--times", times}), {"a.png", "--times"});
  }
  expect_refusal(merge_of(bracket(), {"--times", "1,2"}), {"2", "3"});
  expect_refusal(merge_of(bracket(), {"--times", "1,two,3"}), {"two"});
}

TEST_F(BadInput, TimesThatContradictTheBrightness) {
  expect_refusal(merge_of(bracket(), {"--times", "0.16,0.04,0.01"}), {"darker", ".png", "--times"});
  expect_refusal(merge_of(bracket(), {"--times", "0.16,0.04,0.01", "--response", "srgb"}), {"darker"});
}

TEST_F(BadInput, AProbeOfNaN) {
  RadianceMap map;
  map.rgb = Image<float>(8, 4, 3);
  for (int y = 0; y < 4; ++y) std::fill(map.rgb.row(y), map.rgb.row(y) + 24, std::numeric_limits<float>::quiet_NaN());
  write_map(scratch_ / "nan.exr", map, {}, {SampleType::kFloat, "zip"});
  expect_refusal({"sh", at("nan.exr")}, {"nan.exr", "NaN"});
  expect_refusal({"render", "--probe", at("nan.exr"), "-o", at("r.exr")}, {"nan.exr"});
  // One bad pixel in a good probe is replaced, and said.
  for (int y = 0; y < 4; ++y) std::fill(map.rgb.row(y), map.rgb.row(y) + 24, 1.0f);
  map.rgb(3, 1, 0) = std::numeric_limits<float>::quiet_NaN();
  write_map(scratch_ / "one.exr", map, {}, {SampleType::kFloat, "zip"});
  const Json answer = answer_of({"sh", at("one.exr")});
  EXPECT_TRUE(answer.contains("warnings"));
  EXPECT_TRUE(answer["coefficients"][0][0].is_number()) << "a NaN would be null";
}

TEST_F(BadInput, ABlackProbeLightsNothing) {
  RadianceMap map;
  map.rgb = Image<float>(8, 4, 3);
  write_map(scratch_ / "black.exr", map);
  const Json sh = answer_of({"sh", at("black.exr")});
  EXPECT_EQ(sh["coefficients"][0][0].get<double>(), 0);
  answer_of({"render", "--probe", at("black.exr"), "-o", at("r.exr"), "--size", "16x12", "--samples", "2"});
  const Json info = answer_of({"info", at("r.exr")})["files"][0];
  EXPECT_EQ(info["nan"], 0);
}

TEST_F(BadInput, NoBallIsSaid) {
  expect_refusal({"probe", bracket()[0], bracket()[1], bracket()[2], "-o", at("p.exr")}, {"no mirror ball", "--ball"});
  expect_refusal({"probe", bracket()[0], bracket()[1], "-o", at("p.exr"), "--ball", "10,10,-3"}, {"--ball"});
  expect_refusal({"probe", bracket()[0], bracket()[1], "-o", at("p.exr"), "--ball", "20,15,9", "--distance", "0.5"},
                 {"--distance"});
}

}  // namespace
}  // namespace hdr::test
