// The sample programs, as a reader of the README would run them.
#include "libhdr/io/read.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

TEST(Samples, PhotographsToProbeToPicture) {
  const ScratchDir scratch;
  const auto at = [&](const std::string& name) { return (scratch / name).string(); };
  write_world(scratch / "world.exr");
  const Json shots = answer_of({"simulate", at("world.exr"), "-o", at("shots"), "--ball", "--size", "400x300",
                                "--times", "1/1000,1/250,1/60,1/40,1/15,1/4"});
  const std::string folder = std::string(HDR_BUILD_DIR) + "/samples/";
  std::vector<std::string> bracket = {folder + "bracket_to_probe", at("probe.exr")};
  for (const Json& frame : shots["frames"]) bracket.push_back(frame["path"]);
  const CommandResult probe = run_command(bracket);
  ASSERT_EQ(probe.exit_code, 0) << probe.err;
  EXPECT_EQ(read_map(scratch / "probe.exr").map.size(), (Size{1024, 512}));

  const CommandResult ball = run_command({folder + "ball_to_probe", at("shots/truth.exr"), at("ball.exr")});
  ASSERT_EQ(ball.exit_code, 0) << ball.err;
  const CommandResult render = run_command({folder + "probe_to_render", at("ball.exr"), at("render.png")});
  ASSERT_EQ(render.exit_code, 0) << render.err;
  EXPECT_NE(render.out.find("irradiance"), std::string::npos);
  EXPECT_EQ(read_photo(scratch / "render.png").size(), (Size{320, 240}));
  EXPECT_EQ(run_command({folder + "bracket_to_probe"}).exit_code, 1) << "misuse is said, not a crash";
}

TEST(Samples, HdrVersusLdrIsOnePictureAnOperation) {
  const ScratchDir scratch;
  write_world(scratch / "world.exr");
  const std::string program = std::string(HDR_BUILD_DIR) + "/samples/hdr_versus_ldr";
  const CommandResult result = run_command({program, (scratch / "world.exr").string(), (scratch / "out").string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* name : {"gaussian", "motion", "exposure", "harmonics"}) {
    const Photo picture = read_photo(scratch.path() / "out" / (std::string(name) + ".png"));
    EXPECT_EQ(picture.size(), (Size{1446, 726})) << name;
  }
}

}  // namespace
}  // namespace hdr::test
