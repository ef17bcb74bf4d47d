// The command's manners: its map, its help, its exit codes.
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

const char* const kVerbs[] = {"info",    "simulate", "shoot",     "calibrate", "align",   "merge",
                              "unwrap",  "probe",    "sh",        "render",    "tonemap", "diff",
                              "cameras", "lights",   "prefilter", "prt",       "unclip",  "bench"};

TEST(Command, AlonePrintsAMapOfEveryVerb) {
  const CommandResult result = run_hdr({});
  EXPECT_EQ(result.exit_code, 0);
  for (const char* verb : kVerbs) EXPECT_NE(result.out.find(std::string(" ") + verb + " "), std::string::npos) << verb;
}

TEST(Command, EveryHelpOpensWithARunnableLine) {
  for (const char* verb : kVerbs) {
    const CommandResult result = run_hdr({verb, "--help"});
    EXPECT_EQ(result.exit_code, 0) << verb;
    const std::string first = result.out.substr(0, result.out.find('\n'));
    EXPECT_EQ(first.find(std::string("  hdr ") + verb + " "), 0u) << verb << " --help opens with: " << first;
  }
}

TEST(Command, MisuseIsExitCode2) {
  EXPECT_EQ(run_hdr({"enlighten"}).exit_code, 2) << "an unknown verb";
  EXPECT_EQ(run_hdr({"merge"}).exit_code, 2) << "no shots";
  EXPECT_EQ(run_hdr({"merge", "a.jpg", "--no-such-option"}).exit_code, 2);
  EXPECT_EQ(run_hdr({"merge", "a.jpg", "-o", "m.exr", "--weight", "heavy"}).exit_code, 2);
  EXPECT_EQ(run_hdr({"unwrap", "a.exr", "-o", "m.exr", "--threads", "0"}).exit_code, 2);
}

TEST(Command, VersionIsOneLineEverywhere) {
  const std::string version = run_hdr({"--version"}).out;
  EXPECT_EQ(version.find("hdr "), 0u);
  EXPECT_EQ(run_hdr({"merge", "--version"}).out, version);
}

}  // namespace
}  // namespace hdr::test
