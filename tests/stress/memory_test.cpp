// Memory that runs out is an error of one line, not a killed process: commands under `ulimit -v`, on files whose
// headers promise more than there is.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "tests/cli/fixture.h"

namespace hdr::stress {
namespace {

/// The command with this many kB of addresses. Two threads, each of whose arenas takes 64 MB.
test::CommandResult run_within(int kilobytes, const std::string& arguments) {
  return test::run_command(
      {"bash", "-c",
       "ulimit -v " + std::to_string(kilobytes) + "; exec '" + HDR_BINARY + "' " + arguments + " --threads 2"});
}

void expect_one_line(const test::CommandResult& result, const std::string& what) {
  EXPECT_EQ(result.exit_code, 1) << what << "\n" << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << what << "\n" << result.err;
  EXPECT_NE(result.err.find("memory"), std::string::npos) << what << "\n" << result.err;
}

constexpr int kLimit = 1200000;  // kB: the program and its libraries take half of that

class MemoryStress : public ::testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer takes terabytes of addresses for itself";
#endif
    test::write_world(folder_ / "small.exr");
    ASSERT_EQ(run_within(kLimit, "info '" + at("small.exr") + "'").exit_code, 0) << "small things go on";
  }
  std::string at(const std::string& name) const {
    return (folder_ / name).string();
  }
  void write_sparse(const std::string& name, int width, int height) const {
    std::ofstream(at(name), std::ios::binary) << "PF\n" << width << ' ' << height << "\n-1.0\n";
    std::filesystem::resize_file(at(name), std::filesystem::file_size(at(name)) + std::uintmax_t{12} *
                                                                                      static_cast<unsigned>(width) *
                                                                                      static_cast<unsigned>(height));
  }

  test::ScratchDir folder_;
};

TEST_F(MemoryStress, AMapThatDoesNotFitIsALine) {
  write_sparse("large.pfm", 20000, 10000);  // 2.4 GB
  for (const char* verb : {"convert '{}' '{}.exr'", "sh '{}'", "lights '{}' -n 4", "tonemap '{}' -o '{}.png'",
                           "filter '{}' -o '{}.exr' --gaussian 3", "diff '{}' '{}'"}) {
    std::string line = verb;
    for (std::size_t at_brace; (at_brace = line.find("{}")) != std::string::npos;)
      line.replace(at_brace, 2, at("large.pfm"));
    expect_one_line(run_within(kLimit, line), line);
  }
  EXPECT_FALSE(std::filesystem::exists(at("large.pfm.exr"))) << "nothing half written";
}

TEST_F(MemoryStress, AnOutputThatDoesNotFitIsALine) {
  const std::string line =
      "unwrap '" + at("small.exr") + "' -o '" + at("large.exr") + "' --from latlong --to angular --width 16000";
  const test::CommandResult result = run_within(kLimit, line);
  // Written in bands it may fit: then it must be whole.
  if (result.exit_code != 0) {
    expect_one_line(result, line);
    EXPECT_FALSE(std::filesystem::exists(at("large.exr")));
  }
  const std::string render =
      "render --probe '" + at("small.exr") + "' -o '" + at("r.exr") + "' --size 30000x30000 --samples 1";
  expect_one_line(run_within(kLimit, render), render);
}

TEST_F(MemoryStress, ABracketThatDoesNotFitIsALine) {
  const std::string simulate =
      "simulate '" + at("small.exr") + "' -o '" + at("shots") + "' --times 1/4,1,4 --size 20000x10000 --format png";
  expect_one_line(run_within(kLimit, simulate), simulate);
}

}  // namespace
}  // namespace hdr::stress
