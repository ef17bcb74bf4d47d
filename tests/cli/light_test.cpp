// Light from a probe, on the command line.
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

}  // namespace
}  // namespace hdr::test
