// hdr unwrap: any projection to any other; what it writes it reads back without being told.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "libhdr/filter/compare.h"
#include "libhdr/io/read.h"
#include "libhdr/probe/projection.h"
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
  expect_refusal({"unwrap", at("f.exr"), at("b.exr"), "-o", at("x.exr"), "--level"}, {"--level", "one picture"});
  expect_refusal({"unwrap", at("f.exr"), at("f.exr"), "-o", at("x.exr"), "--from", "fisheye", "--fov", "150"},
                 {"f.exr", "gap", "--fov"});
  EXPECT_EQ(run_hdr({"unwrap", world(), world(), "-o", at("x.exr")}).exit_code, 2);
}

/// Of so few waves that resampling is exact to the digits that are asked for here. Degrees right and up.
float smooth_light(double right, double up) {
  const double c = std::cos(up * kDegree);
  return static_cast<float>(2 + std::sin(3 * right * kDegree) * c * c * c + 0.5 * std::sin(5 * up * kDegree));
}

TEST_F(Unwrap, APartOfTheSphereStaysWhereItWas) {
  RadianceMap map;
  map.rgb = Image<float>(256, 128, 3);
  map.projection = "latlong";
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 256; ++x) {
      std::fill_n(map.rgb.pixel(x, y), 3, smooth_light((x + 0.5) / 256 * 360 - 180, 90 - (y + 0.5) / 128 * 180));
    }
  }
  write_map(scratch_ / "smooth.exr", map, {}, {SampleType::kFloat, "zip"});
  answer_of({"unwrap", at("smooth.exr"), "-o", at("part.exr"), "--to", "panorama", "--fov", "180", "--vfov", "90",
             "--centre", "30,10", "--width", "256", "--type", "float"});
  const RadianceMap part = read_map(scratch_ / "part.exr").map;
  EXPECT_EQ(part.projection, "panorama fov=180 vfov=90 azimuth=30 elevation=10");
  ASSERT_EQ(part.size(), (Size{256, 128}));
  EXPECT_TRUE(part.alpha.empty()) << "all of it is shown";
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 256; ++x) {
      const float truth = smooth_light(30 - 90 + (x + 0.5) / 256 * 180, 10 + 45 - (y + 0.5) / 128 * 90);
      ASSERT_NEAR(part.rgb(x, y, 1), truth, 1e-4) << x << " " << y;
    }
  }

  answer_of({"unwrap", at("part.exr"), "-o", at("back.exr"), "--width", "256", "--type", "float"});
  const RadianceMap back = read_map(scratch_ / "back.exr").map;
  ASSERT_FALSE(back.alpha.empty());
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 256; ++x) {
      const double right = (x + 0.5) / 256 * 360 - 180, up = 90 - (y + 0.5) / 128 * 180;
      const double within = std::min(90 - std::abs(right - 30), 45 - std::abs(up - 10));
      // The outermost pixels of the part reach half their width over its edge, and have nothing there to be made from.
      if (std::abs(within) < 0.36) continue;
      ASSERT_EQ(back.alpha(x, y), within > 0 ? 1.0f : 0.0f) << x << " " << y;
      ASSERT_NEAR(back.rgb(x, y, 1), within > 0 ? smooth_light(right, up) : 0.0f, within < 3 ? 0.04 : 1e-3)
          << x << " " << y;
    }
  }

  // 40 of 256 columns in, 20 of 128 rows down: what the cropped scan shows is where it was.
  answer_of({"unwrap", at("smooth.exr"), "-o", at("crop.exr"), "--crop", "40,20,100,70", "--to", "panorama", "--fov",
             "80", "--vfov", "40", "--centre", "-80,20", "--width", "80", "--type", "float"});
  const RadianceMap crop = read_map(scratch_ / "crop.exr").map;
  EXPECT_EQ(crop.projection, "panorama fov=80 vfov=40 azimuth=-80 elevation=20");
  EXPECT_NEAR(crop.rgb(40, 20, 1), smooth_light(-79.5, 19.5), 1e-3);
}

TEST_F(Unwrap, AScanOfUnknownFieldIsWhatTheOptionsSay) {
  // 360 x 120 degrees with ten rows of nothing above.
  const RadianceMap truth = read_map(world()).map;
  RadianceMap scan;
  scan.rgb = Image<float>(256, 95, 3);
  for (int y = 0; y < 85; ++y) std::copy_n(truth.rgb.row(y + 21), 3 * 256, scan.rgb.row(y + 10));
  write_map(scratch_ / "scan.exr", scan, {}, {SampleType::kFloat, "zip"});
  answer_of({"unwrap", at("scan.exr"), "-o", at("s.exr"), "--from", "panorama", "--crop", "0,10,256,85", "--centre",
             "0,0.703125", "--width", "256", "--type", "float"});
  const RadianceMap sphere = read_map(scratch_ / "s.exr").map;
  double off = 0;
  for (int y = 30; y < 100; ++y) {
    for (int x = 0; x < 256; ++x) off += std::abs(std::log2(sphere.rgb(x, y, 1) / truth.rgb(x, y, 1)));
  }
  EXPECT_LT(off / (70 * 256), 0.01);
  EXPECT_EQ(sphere.alpha(100, 10), 0);
  EXPECT_EQ(sphere.alpha(100, 64), 1);
  expect_refusal({"unwrap", at("scan.exr"), "-o", at("x.exr"), "--from", "panorama", "--fov", "370"},
                 {"370", "--crop"});
  expect_refusal({"unwrap", at("scan.exr"), "-o", at("x.exr"), "--from", "panorama", "--crop", "0,10,257,85"},
                 {"scan.exr: --crop", "256x95"});
  expect_refusal({"unwrap", at("scan.exr"), "-o", at("x.exr"), "--from", "panorama", "--centre", "0,80"},
                 {"beyond a pole"});
  expect_refusal({"unwrap", at("scan.exr"), "-o", at("x.exr")}, {"scan.exr", "--from", "panorama"});
}

TEST_F(Unwrap, TheHorizonBecomesLevel) {
  answer_of({"unwrap", world(), "-o", at("tilted.exr"), "--rotate", "8,0,-5", "--width", "256", "--type", "float"});
  // Where the tilted map has two points of the horizon.
  const LatLong map{{256, 128}};
  const Mat3 turn = rotation_from_degrees({8, 0, -5});
  const Vec2 a = *map.px_from_dir(turn * Vec3(0, 0, 1)), b = *map.px_from_dir(turn * Vec3(1, 0, 0));
  const std::string points =
      std::to_string(a.x()) + "," + std::to_string(a.y()) + "," + std::to_string(b.x()) + "," + std::to_string(b.y());
  answer_of({"unwrap", at("tilted.exr"), "-o", at("l.exr"), "--horizon", points, "--width", "256", "--type", "float"});
  const RadianceMap level = read_map(scratch_ / "l.exr").map, truth = read_map(world()).map;
  // Up to a turn about the vertical: the mean of each row is as it was, but for two resamplings of a sun, and of the
  // step at the horizon, which a degree and a half of tilt would carry over the three rows that are left out.
  for (int y = 12; y < 116; ++y) {
    if (y >= 63 && y <= 65) continue;
    double mean = 0, expected = 0;
    for (int x = 0; x < 256; ++x) {
      mean += static_cast<double>(level.rgb(x, y, 1));
      expected += static_cast<double>(truth.rgb(x, y, 1));
    }
    EXPECT_NEAR(mean / expected, 1, 0.08) << "row " << y;
  }
  expect_refusal({"unwrap", at("tilted.exr"), "-o", at("x.exr"), "--horizon", "10,20"}, {"--horizon", "two"});
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
