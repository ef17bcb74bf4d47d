// Photographs of a scene that is known become the sphere that they were taken in.
#include <gtest/gtest.h>

#include "libhdr/io/read.h"
#include "libhdr/probe/projection.h"
#include "tests/cli/carpet_file.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

struct Turn {
  const char* name;
  const char* rotate;  ///< of the scene
  Vec3 degrees;
};
const Turn kTurns[] = {{"a", "4,0,2", {4, 0, 2}},       {"b", "-5,62,-3", {-5, 62, -3}}, {"c", "3,118,1", {3, 118, 1}},
                       {"d", "-2,181,4", {-2, 181, 4}}, {"e", "6,240,-2", {6, 240, -2}}, {"f", "0,301,0", {0, 301, 0}}};

class StitchCommand : public ::testing::Test {
 protected:
  void SetUp() override { write_carpet(scratch_ / "world.exr", world_); }
  std::string photograph(const Turn& turn, const std::string& times, const std::string& format = "jpg") {
    const std::string folder = (scratch_ / turn.name).string();
    answer_of({"simulate", (scratch_ / "world.exr").string(), "-o", folder, "--fov", "85", "--size", "640x480",
               "--rotate", turn.rotate, "--times", times, "--format", format});
    return folder;
  }
  static Mat3 truth(const Turn& turn) {
    return rotation_from_degrees(kTurns[0].degrees) * rotation_from_degrees(turn.degrees).transpose();
  }
  static void expect_rotations(const Json& views, double most_degrees, double most_focal) {
    ASSERT_EQ(views.size(), std::size(kTurns));
    const double focal = 1 / std::tan(42.5 * kDegree);
    for (std::size_t k = 0; k < views.size(); ++k) {
      ASSERT_TRUE(views[k]["used"].get<bool>()) << views[k].dump();
      Mat3 m;
      for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = views[k]["probe_from_view"][static_cast<std::size_t>(i)];
      EXPECT_LT(Eigen::AngleAxisd(m.transpose() * truth(kTurns[k])).angle() / kDegree, most_degrees) << kTurns[k].name;
      EXPECT_NEAR(1 / std::tan(0.5 * kDegree * views[k]["fov"].get<double>()) / focal, 1, most_focal);
    }
  }
  /// Median of |ratio - 1| against the world as the first photograph's camera sees it, where `map` shows it.
  double median_error(const std::string& map) {
    const ReadMap result = read_map(map);
    const Mat3 world_from_probe = rotation_from_degrees(kTurns[0].degrees).transpose();
    std::vector<double> errors;
    for (int y = result.map.rgb.height() / 3; y < 2 * result.map.rgb.height() / 3; ++y) {
      for (int x = 0; x < result.map.rgb.width(); ++x) {
        const Vec3 d = dir_from_latlong((x + 0.5) / result.map.rgb.width(), (y + 0.5) / result.map.rgb.height());
        errors.push_back(std::abs(static_cast<double>(result.map.rgb(x, y, 1)) / world_(world_from_probe * d) - 1));
      }
    }
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    return errors[errors.size() / 2];
  }

  const Carpet world_;
  ScratchDir scratch_;
};

TEST_F(StitchCommand, RadianceMapsBecomeTheirWorld) {
  std::vector<std::string> arguments = {"stitch"};
  for (const Turn& turn : kTurns) arguments.push_back(photograph(turn, "1/60") + "/truth.exr");
  const std::string output = (scratch_ / "sphere.exr").string();
  for (const char* word : {"-o", output.c_str(), "--width", "1024", "--nadir"}) arguments.push_back(word);
  const Json answer = answer_of(arguments);
  expect_rotations(answer["views"], 0.1, 0.003);
  for (const Json& view : answer["views"]) {
    EXPECT_NEAR(view["gain"].get<double>(), 1, 0.01);
    EXPECT_LT(view["residual_px"].get<double>(), 0.5);
  }
  EXPECT_GT(answer["nadir"]["radius_degrees"].get<double>(), 30);
  EXPECT_GT(answer["shown"].get<double>(), 0.4);
  EXPECT_LT(median_error(output), 0.03);
  EXPECT_EQ(answer["projection"], "latlong");
}

// Each direction has a bracket of three shots, metered by itself; the merged maps have one scale.
TEST_F(StitchCommand, FoldersAreMergedFirst) {
  std::vector<std::string> arguments = {"stitch"};
  for (const Turn& turn : kTurns) arguments.push_back(photograph(turn, "1/250,1/60,1/15"));
  const std::string output = (scratch_ / "sphere.exr").string();
  for (const char* word : {"-o", output.c_str(), "--width", "512"}) arguments.push_back(word);
  const Json answer = answer_of(arguments);
  expect_rotations(answer["views"], 0.2, 0.005);
  const double first = Json::parse(bytes_of(scratch_ / "a" / "bracket.json"))["k"];
  for (std::size_t k = 0; k < std::size(kTurns); ++k) {
    const double here = Json::parse(bytes_of(scratch_ / kTurns[k].name / "bracket.json"))["k"];
    EXPECT_NEAR(answer["views"][k]["gain"].get<double>() * here / first, 1, 0.04) << kTurns[k].name;
  }
}

TEST_F(StitchCommand, PhotographsFromOneFolder) {
  std::filesystem::create_directories(scratch_ / "all");
  for (const Turn& turn : kTurns) {
    const std::string folder = photograph(turn, "1/60");
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".jpg") {
        std::filesystem::copy_file(entry.path(), scratch_ / "all" / (std::string(turn.name) + ".jpg"));
      }
    }
  }
  const std::string output = (scratch_ / "sphere.exr").string();
  const Json answer = answer_of({"stitch", (scratch_ / "all").string(), "-o", output, "--width", "512", "--level"});
  for (const Json& view : answer["views"]) EXPECT_TRUE(view["used"].get<bool>());
}

TEST_F(StitchCommand, WhatCannotBeStitchedIsSaidInOneLine) {
  const std::string a = photograph(kTurns[0], "1/60") + "/truth.exr", d = photograph(kTurns[3], "1/60") + "/truth.exr";
  const std::string output = (scratch_ / "sphere.exr").string();
  expect_refusal({"stitch", a, "-o", output}, {"one photograph", "overlap"});
  expect_refusal({"stitch", a, d, "-o", output}, {"truth.exr", "overlap by a third"});
  expect_refusal({"stitch", a, a, "-o", output}, {"the same photograph"});
  expect_refusal({"stitch", a, (scratch_ / "absent.exr").string(), "-o", output}, {"absent.exr"});
  expect_refusal({"stitch", a, (scratch_ / "world.exr").string(), "-o", output},
                 {"world.exr", "latlong", "rectilinear"});
  EXPECT_FALSE(std::filesystem::exists(output));
}

}  // namespace
}  // namespace hdr::test
