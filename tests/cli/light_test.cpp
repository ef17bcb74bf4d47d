// Light from a probe, on the command line.
#include "libhdr/io/read.h"
#include "libhdr/light/lights.h"
#include "libhdr/probe/ball_normal.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

TEST(LightCommands, LightsCarryTheProbesLightInEveryFormat) {
  const ScratchDir scratch;
  write_world(scratch / "world.exr");
  const std::string world = (scratch / "world.exr").string();
  const Json sh = answer_of({"sh", world, "--degree", "0"});
  for (const std::string method : {"median-cut", "variance-cut", "structured", "kollig-keller"}) {
    const Json answer = answer_of({"lights", world, "-n", "20", "--method", method});
    ASSERT_EQ(answer["lights"].size(), 20u) << method;
    double sum = 0, sphere = 0;
    for (const Json& light : answer["lights"]) {
      sum += light["irradiance"][1].get<double>();
      sphere += light["solid_angle"].get<double>();
    }
    EXPECT_NEAR(sum / (sh["coefficients"][0][1].get<double>() * std::sqrt(4 * kPi)), 1, 1e-6) << method;
    EXPECT_NEAR(sphere, 4 * kPi, 1e-6);
    EXPECT_LT(answer["irradiance_error"].get<double>(), 0.1);
  }
  for (const std::string name : {"l.json", "l.usda", "l.rad", "strata.png"}) {
    const std::string option = name == "strata.png" ? "--picture" : "-o";
    answer_of({"lights", world, "-n", "8", option, (scratch / name).string()});
    EXPECT_GT(std::filesystem::file_size(scratch / name), 100u) << name;
  }
  expect_refusal({"lights", world, "-o", (scratch / "l.max").string()}, {"l.max", ".usda"});
}

TEST(LightCommands, HarmonicsOfTheDegreeThatAnErrorAsksFor) {
  const ScratchDir scratch;
  write_world(scratch / "world.exr");
  const std::string world = (scratch / "world.exr").string();
  const Json answer = answer_of({"sh", world, "--degree", "auto", "--error", "0.1", "--window", "auto"});
  const int degree = answer["degree"];
  EXPECT_EQ(static_cast<int>(answer["coefficients"].size()), (degree + 1) * (degree + 1));
  for (const Json& least : answer["least_irradiance"]) EXPECT_GE(least.get<double>(), -1e-9);
  EXPECT_EQ(run_hdr({"sh", world, "--degree", "33"}).exit_code, 2);
  EXPECT_EQ(run_hdr({"sh", world, "--degree", "two"}).exit_code, 2);
  for (const std::string format : {"json", "c", "threejs", "filament", "unity"}) {
    answer_of({"sh", world, "--format", format, "-o", (scratch / format).string()});
    EXPECT_GT(std::filesystem::file_size(scratch / format), 100u);
  }
  answer_of({"sh", world, "--irradiance-map", (scratch / "cube").string(), "--cube", "--width", "8"});
  for (const char* face : {"px", "nx", "py", "ny", "pz", "nz"})
    EXPECT_TRUE(std::filesystem::exists(scratch / "cube" / (std::string(face) + ".exr"))) << face;
}

TEST(LightCommands, HarmonicsFittedToIrradianceErrLess) {
  const ScratchDir scratch;
  write_world(scratch / "world.exr");
  const std::string world = (scratch / "world.exr").string();
  const Json answer = answer_of({"sh", world, "--fit", "irradiance"});
  EXPECT_EQ(answer["coefficients"].size(), 9u);
  EXPECT_LT(answer["fit_error"].get<double>(), 0.9 * answer["projection_error"].get<double>());
  EXPECT_GE(answer["error_bound"].get<double>(), 0.99 * answer["fit_error"].get<double>());
  EXPECT_EQ(run_hdr({"sh", world, "--fit", "irradiance", "--degree", "auto"}).exit_code, 2);
  EXPECT_EQ(run_hdr({"sh", world, "--fit", "radiance"}).exit_code, 2);
}

TEST(LightCommands, PrefilteredLevelsGrowDuller) {
  const ScratchDir scratch;
  write_world(scratch / "world.exr");
  for (const bool cube : {false, true}) {
    const std::string folder = (scratch / (cube ? "cube" : "levels")).string();
    std::vector<std::string> line{
        "prefilter", (scratch / "world.exr").string(), "-o", folder, "--levels", "4", "--width", "32", "--samples",
        "64"};
    if (cube) line.push_back("--cube");
    const Json answer = answer_of(line);
    ASSERT_EQ(answer["levels"].size(), 4u);
    EXPECT_EQ(answer["levels"][3]["roughness"], 1.0);
    double before = 1e30;
    for (const Json& level : answer["levels"]) {
      const std::string path = level["path"];
      const Json info = answer_of({"info", cube ? path + "/pz.exr" : path});
      if (cube) continue;
      EXPECT_LT(info["files"][0]["max"].get<double>(), before) << path;
      before = info["files"][0]["max"];
    }
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(folder) / "brdf.exr"));
  }
}

TEST(LightCommands, LevelsByFrequencyAreTheSampledOnesWithADegreeAndABound) {
  const ScratchDir scratch;
  write_world(scratch / "world.exr");
  const std::string world = (scratch / "world.exr").string();
  const std::string sampled = (scratch / "sampled").string(), bands = (scratch / "bands").string();
  const auto levels = [&](const std::string& folder, const std::string& method) {
    return answer_of({"prefilter", world, "-o", folder, "--levels", "4", "--width", "32", "--samples", "2048",
                      "--method", method, "--error", "0.02"})["levels"];
  };
  const Json a = levels(sampled, "sampling"), b = levels(bands, "frequency");
  int by_frequency = 0;
  for (std::size_t k = 0; k < b.size(); ++k) {
    if (b[k]["method"] != "frequency") continue;
    ++by_frequency;
    EXPECT_LE(b[k]["error_bound"].get<double>(), 0.02);
    EXPECT_GT(b[k]["degree"].get<int>(), 2);
    EXPECT_LT(answer_of({"diff", a[k]["path"], b[k]["path"]})["rel_rmse"].get<double>(), 0.03) << k;
  }
  EXPECT_GE(by_frequency, 2);
  EXPECT_EQ(b[0]["method"], "sampling") << "a mirror has no last band";
  answer_of({"prefilter", world, "-o", (scratch / "cube").string(), "--levels", "2", "--width", "8", "--cube",
             "--method", "frequency"});
  EXPECT_TRUE(std::filesystem::exists(scratch / "cube" / "level_1" / "pz.exr"));
  EXPECT_EQ(run_hdr({"prefilter", world, "-o", bands, "--method", "fourier"}).exit_code, 2);
}

// NaN, infinite, negative, huge: what the file means otherwise stays, and what was changed is said.
TEST(LightCommands, HostileMapsAreMendedWithAReport) {
  const ScratchDir scratch;
  write_world(scratch / "world.exr", 64);
  const double clean = answer_of({"sh", (scratch / "world.exr").string()})["coefficients"][0][1];
  constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {kNan, kInf, -1e30f}) {
    RadianceMap map = read_map(scratch / "world.exr").map;
    for (int c = 0; c < 3; ++c) map.rgb(5, 28, c) = bad;
    const std::string path = (scratch / "bad.exr").string();
    write_map(path, map, {}, {SampleType::kFloat, "zip"});
    const Json sh = answer_of({"sh", path}), lights = answer_of({"lights", path, "-n", "8"});
    for (const Json* answer : {&sh, &lights})
      EXPECT_FALSE((*answer)["warnings"].empty()) << bad << " went by in silence";
    // An infinite pixel is a sun of the largest sample; one pixel of the ground more or less is little else.
    const double l00 = sh["coefficients"][0][1];
    EXPECT_GT(l00, 0.97 * clean) << bad;
    if (bad != kInf) {
      EXPECT_LT(l00, 1.03 * clean) << bad;
    }
    double flux = 0;
    for (const Json& light : lights["lights"]) flux += light["irradiance"][1].get<double>();
    EXPECT_NEAR(flux / (l00 * std::sqrt(4 * kPi)), 1, 1e-6) << "no light is lost beside a bad pixel";
    const std::string picture = (scratch / "picture.exr").string();
    answer_of({"render", "--probe", path, "-o", picture, "--size", "32x24", "--samples", "16"});
    EXPECT_EQ(answer_of({"info", picture})["files"][0]["nan"], 0);
  }
}

TEST(LightCommands, BlackAndHugeMapsHaveAnswers) {
  const ScratchDir scratch;
  for (const float value : {0.0f, 1e30f}) {
    RadianceMap map;
    map.rgb = Image<float>(16, 8, 3);
    map.projection = "latlong";
    for (int y = 0; y < 8; ++y) std::fill_n(map.rgb.row(y), 48, value);
    const std::string path = (scratch / "map.exr").string();
    write_map(path, map, {}, {SampleType::kFloat, "zip"});
    for (const std::string method : {"median-cut", "variance-cut", "structured", "kollig-keller"}) {
      const Json lights = answer_of({"lights", path, "-n", "5", "--method", method})["lights"];
      ASSERT_EQ(lights.size(), 5u);
      double flux = 0;
      for (const Json& light : lights) flux += light["irradiance"][0].get<double>();
      EXPECT_NEAR(flux, 4 * kPi * value, 1e-6 * flux);
    }
    const std::string folder = (scratch / "levels").string();
    const Json levels =
        answer_of({"prefilter", path, "-o", folder, "--levels", "2", "--width", "8", "--samples", "16"});
    const Json info = answer_of({"info", levels["levels"][1]["path"]})["files"][0];
    EXPECT_NEAR(info["max"].get<double>(), value, 1e-5 * value);
    EXPECT_EQ(info["nan"], 0);
  }
}

TEST(LightCommands, ASunComesBackToWhatTheMeterRead) {
  const ScratchDir scratch;
  write_world(scratch / "world.exr");
  RadianceMap map = read_map(scratch / "world.exr").map;
  double truth = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 256; ++x) {
      const float* p = map.rgb.pixel(x, y);
      truth += (0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]) * std::cos(kPi * (y + 0.5) / 128) *
               latlong_pixel_solid_angle(y, 256, 128);
    }
  for (int y = 0; y < 128; ++y)
    for (int k = 0; k < 768; ++k) map.rgb.row(y)[k] = std::min(20.0f, map.rgb.row(y)[k]);
  map.white_luminance = 100;
  const std::string clipped = (scratch / "clipped.exr").string(), sun = (scratch / "sun.exr").string();
  write_map(clipped, map, {}, {SampleType::kFloat, "zip"});
  const Json answer = answer_of({"unclip", clipped, "-o", sun, "--target-lux", std::to_string(100 * truth)});
  EXPECT_EQ(answer["regions"], 1);
  EXPECT_GT(answer["gains"][0][1].get<double>(), 1.5);
  EXPECT_LT(answer["residual"][1].get<double>(), 1e-6);
  expect_refusal({"unclip", (scratch / "world.exr").string(), "-o", sun, "--target-lux", "1000"}, {"whiteLuminance"});
  expect_refusal({"unclip", clipped, "-o", sun}, {"--target-lux", "--diffuse-ball", "--measured"});
}

// Lambert's law under the lights that stand for the map; outside the ball what is behind it.
RadianceMap matt_ball(const std::filesystem::path& world, Size size, const MirrorBall& ball, double albedo) {
  const Image<float> light = read_map(world).map.rgb.clone();
  const auto lights = make_lights(light, {512, LightsMethod::kStructured, std::nullopt, 1}).lights;
  RadianceMap picture;
  picture.rgb = Image<float>(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto normal = normal_from_px(ball, {x + 0.5, y + 0.5});
      const Rgb value = normal ? Rgb(irradiance(lights, *normal) * albedo / kPi) : Rgb(Rgb::Constant(0.02));
      for (int c = 0; c < 3; ++c) picture.rgb(x, y, c) = static_cast<float>(value[c]);
    }
  }
  return picture;
}

TEST(LightCommands, ASunComesBackFromAMattBall) {
  const ScratchDir scratch;
  const auto world = scratch / "world.exr";
  write_world(world);
  const Disc disc{95, 82, 64};
  const std::string ball = (scratch / "ball.exr").string(), clipped = (scratch / "clipped.exr").string(),
                    sun = (scratch / "sun.exr").string();
  write_map(ball, matt_ball(world, {200, 160}, {disc}, 0.5), {}, {SampleType::kFloat, "zip"});
  RadianceMap map = read_map(world).map;
  for (int y = 0; y < 128; ++y)
    for (int k = 0; k < 768; ++k) map.rgb.row(y)[k] = std::min(20.0f, map.rgb.row(y)[k]);
  write_map(clipped, map, {}, {SampleType::kFloat, "zip"});
  const double truth = answer_of({"sh", world.string(), "--degree", "0"})["coefficients"][0][1];
  const double before = answer_of({"sh", clipped, "--degree", "0"})["coefficients"][0][1];
  EXPECT_LT(before, 0.9 * truth);
  for (const std::string albedo : {"0.5", "auto"}) {
    const Json answer =
        answer_of({"unclip", clipped, "-o", sun, "--diffuse-ball", ball, "--ball", "95,82,64", "--albedo", albedo});
    EXPECT_EQ(answer["regions"], 1);
    EXPECT_GT(answer["readings"].get<int>(), 300);
    EXPECT_LT(answer["residual"][1].get<double>(), 0.03);
    EXPECT_NEAR(answer_of({"sh", sun, "--degree", "0"})["coefficients"][0][1].get<double>() / truth, 1, 0.02) << albedo;
    if (albedo == "auto") {
      EXPECT_NEAR(answer["albedo"].get<double>(), 0.5, 0.02);
    }
  }
  const auto refused = [&](std::vector<std::string> more, const std::vector<std::string>& words) {
    std::vector<std::string> line{"unclip", clipped, "-o", sun, "--diffuse-ball", ball};
    line.insert(line.end(), more.begin(), more.end());
    expect_refusal(line, words);
  };
  refused({"--ball", "95,82,64", "--albedo", "1.5"}, {"--albedo 1.5", "at most 1"});
  refused({"--ball", "95,82,3"}, {"ball.exr", "normals", "--ball"});
  refused({"--ball", "900,82,60"}, {"--ball", "outside"});
  refused({"--ball", "95,82,64", "--measured", "0,1,0=1,1,1"}, {"--albedo"});
  expect_refusal({"unclip", clipped, "-o", sun, "--diffuse-ball", (scratch / "none.exr").string()}, {"none.exr"});
}

TEST(LightCommands, AMeshKeepsItsTransfer) {
  const ScratchDir scratch;
  write_world(scratch / "world.exr");
  std::ofstream(scratch / "roof.obj") << "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1 0\n"
                                         "f 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\nf 1 2 3 4\n";
  const std::string prt = (scratch / "roof.prt").string(), picture = (scratch / "roof.exr").string();
  EXPECT_EQ(answer_of({"prt", (scratch / "roof.obj").string(), "-o", prt, "--samples", "64"})["vertices"], 5);
  const Json answer = answer_of({"render", "--probe", (scratch / "world.exr").string(), "--scene", prt, "--method",
                                 "prt", "--size", "64x48", "--samples", "4", "-o", picture});
  EXPECT_EQ(answer["method"], "prt");
  EXPECT_GT(answer_of({"info", picture})["files"][0]["mean"].get<double>(), 0);
  std::filesystem::resize_file(prt, std::filesystem::file_size(prt) - 4);
  expect_refusal({"render", "--probe", (scratch / "world.exr").string(), "--scene", prt, "-o", picture}, {"cut off"});
}

}  // namespace
}  // namespace hdr::test
