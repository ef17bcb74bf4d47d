// hdr unwrap: any projection to any other; what it writes it reads back without being told.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "libhdr/filter/compare.h"
#include "libhdr/io/read.h"
#include "tests/cli/fixture.h"
#include "tests/cli/peak_memory.h"

namespace hdr::test {
namespace {

class Unwrap : public testing::Test {
 protected:
  void SetUp() override { write_world(scratch_ / "world.exr"); }
  std::string at(const std::string& name) const { return (scratch_ / name).string(); }
  std::string world() const { return at("world.exr"); }
  /// Median |log2| of how far a file's lat-long is from the world.
  double distance_from_world(const std::string& name) {
    answer_of({"unwrap", at(name), "-o", at("back.exr"), "--width", "256", "--type", "float"});
    return compare(read_map(scratch_ / "back.exr").map.rgb, read_map(world()).map.rgb, CompareScale::kNone)
        .median_abs_log2;
  }
  ScratchDir scratch_;
};

TEST_F(Unwrap, ReadsBackWhatItWroteWithoutBeingTold) {
  const std::vector<std::vector<std::string>> targets = {
      {"lat-long", "--width", "512"},
      {"angular", "--width", "512"},
      {"mirror-ball", "--width", "512"},
      {"mirror-ball", "--width", "512", "--distance", "20"},
      {"fisheye", "--width", "512", "--fov", "360", "--lens", "equisolid"},
      {"cube-cross", "--width", "512"},
      {"cube-cross-vertical", "--width", "480"},
      {"cube-strip", "--width", "128"},
      {"cube-strip", "--width", "128", "--convention", "opengl"},
      {"cube-faces", "--width", "128"},
      {"cube-faces", "--width", "128", "--convention", "threejs"},
      {"octahedral", "--width", "360"},
      {"octahedral", "--width", "360", "--convention", "pbrt"},
      {"dual-paraboloid", "--width", "720"},
      {"lat-long", "--width", "512", "--convention", "blender"},
      {"lat-long", "--width", "512", "--convention", "pbrt"},
      {"lat-long", "--width", "512", "--convention", "hdrtoolbox"}};
  for (const std::vector<std::string>& target : targets) {
    std::vector<std::string> line = {"unwrap", world(), "-o", at("there.exr"), "--type", "float", "--to"};
    line.insert(line.end(), target.begin(), target.end());
    answer_of(line);
    EXPECT_LE(distance_from_world("there.exr"), 0.02) << line[7] << " " << target.back();
    std::filesystem::remove(scratch_ / "there.exr");
  }
}

TEST_F(Unwrap, SixFilesOfACubeMayBeNamedInAnyOrder) {
  answer_of({"unwrap", world(), "-o", at("c.exr"), "--to", "cube-faces", "--width", "128", "--type", "float"});
  answer_of({"unwrap", at("c_nz.exr"), at("c_py.exr"), at("c_px.exr"), at("c_pz.exr"), at("c_nx.exr"), at("c_ny.exr"),
             "-o", at("back.exr"), "--width", "256", "--type", "float"});
  EXPECT_LE(answer_of({"diff", at("back.exr"), world()})["median_abs_log2"].get<double>(), 0.02);
  expect_refusal({"unwrap", at("c_nz.exr"), "-o", at("x.exr")}, {"c_nz.exr", "cube-faces", "1:6"});
  EXPECT_EQ(run_hdr({"unwrap", at("c_nz.exr"), at("c_px.exr"), "-o", at("x.exr")}).exit_code, 2);
}

TEST_F(Unwrap, ABlenderLatLongReadAsPlainIsTurnedByAQuarter) {
  answer_of({"unwrap", world(), "-o", at("b.exr"), "--convention", "blender", "--width", "256", "--type", "float"});
  const RadianceMap blender = read_map(scratch_ / "b.exr").map, plain = read_map(world()).map;
  EXPECT_EQ(blender.projection, "latlong convention=blender");
  // Its centre shows +X, which ours has a quarter of the width to the left of the centre.
  EXPECT_NEAR(blender.rgb(128, 50, 1), plain.rgb(64, 50, 1), 0.01 * plain.rgb(64, 50, 1));
  // Without its tag (another program's file) --from-convention says the same.
  answer_of({"unwrap", at("b.exr"), "-o", at("p.exr"), "--from", "lat-long", "--from-convention", "blender", "--width",
             "256", "--type", "float"});
  EXPECT_NEAR(read_map(scratch_ / "p.exr").map.rgb(64, 50, 1), plain.rgb(64, 50, 1), 0.01 * plain.rgb(64, 50, 1));
}

TEST_F(Unwrap, TwoOppositeFisheyesBecomeOneSphere) {
  answer_of({"unwrap", world(), "-o", at("f.exr"), "--to", "fisheye", "--fov", "205", "--width", "600"});
  answer_of({"unwrap", world(), "-o", at("b.exr"), "--to", "fisheye", "--fov", "205", "--width", "600", "--rotate",
             "0,178,0"});
  const Json answer = answer_of({"unwrap", at("f.exr"), at("b.exr"), "-o", at("s.exr"), "--width", "256"});
  ASSERT_EQ(answer["views"].size(), 2u);
  for (const Json& view : answer["views"]) {
    for (const char* key : {"from_path", "probe_from_view", "overlap_rms", "gain"}) EXPECT_TRUE(view.contains(key));
  }
  // The second view was turned by 178 degrees: its axes in the probe's are turned back.
  EXPECT_NEAR(answer["views"][1]["probe_from_view"][2].get<double>(), -std::sin(178 * kDegree), 0.01);
  EXPECT_NEAR(answer["views"][1]["gain"].get<double>(), 1, 0.03);
  const auto result = compare(read_map(scratch_ / "s.exr").map.rgb, read_map(world()).map.rgb, CompareScale::kNone);
  EXPECT_LE(result.median_abs_log2, 0.05);

  expect_refusal({"unwrap", at("f.exr"), at("f.exr"), "-o", at("x.exr")}, {"f.exr", "the same photograph twice"});
  expect_refusal({"unwrap", at("f.exr"), at("f.exr"), "-o", at("x.exr"), "--from", "fisheye", "--fov", "150"},
                 {"f.exr", "gap", "--fov"});
  EXPECT_EQ(run_hdr({"unwrap", world(), world(), "-o", at("x.exr")}).exit_code, 2);
}

TEST_F(Unwrap, MemoryIsTheTwoPicturesAndLittleMore) {
  answer_of({"unwrap", world(), "-o", at("in.exr"), "--to", "angular", "--width", "1024"});
  const double before = peak_mb({"unwrap", at("in.exr"), "-o", at("small.exr"), "--width", "64", "--quiet"});
  const double peak = peak_mb({"unwrap", at("in.exr"), "-o", at("large.exr"), "--width", "6144", "--quiet"});
  const double output_mb = 6144.0 * 3072 * 12 / (1 << 20);
  EXPECT_LE(peak - before, output_mb + 100) << "the output takes " << output_mb << " MB";
}

TEST_F(Unwrap, WhatCannotBeIsOneLineThatHelps) {
  expect_refusal({"unwrap", world(), "-o", at("x.exr"), "--to", "fisheye", "--fov", "400"}, {"400", "at most 360"});
  expect_refusal({"unwrap", world(), "-o", at("x.exr"), "--from", "fisheye", "--fov", "400"}, {"400", "at most 360"});
  expect_refusal({"unwrap", world(), "-o", at("x.exr"), "--from", "cube-cross"}, {"world.exr", "4:3", "256x128"});
  expect_refusal({"unwrap", world(), "-o", at("x.exr"), "--to", "cube-cross", "--width", "513"}, {"513", "512"});
  expect_refusal({"unwrap", world(), "-o", at("x.exr"), "--to", "cube-strip", "--convention", "blender"},
                 {"blender", "opengl"});
  EXPECT_EQ(run_hdr({"unwrap", world(), "-o", at("x.exr"), "--to", "cylinder"}).exit_code, 2);
}

TEST_F(Unwrap, TheTestChartSaysEachDirectionOfAFace) {
  answer_of({"simulate", "--test-chart", "--size", "512x256", "-o", at("chart.exr")});
  answer_of({"unwrap", at("chart.exr"), "-o", at("f.exr"), "--to", "cube-faces", "--width", "64", "--type", "float"});
  // 3/8 of the way to the right of OpenEXR's +X face is towards +Z, as far below it is towards -Y.
  const RadianceMap face = read_map(scratch_ / "f_px.exr").map;
  const Vec3 shown = Vec3(1, -0.390625, 0.390625).normalized();  // pixel 44: (44.5 / 64) 2 - 1
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(face.rgb(44, 44, c), 0.5 + 0.5 * shown[c], 0.03) << "channel " << c;
}

}  // namespace
}  // namespace hdr::test
