// The README is true: every block marked `sh run` runs, line by line, in a folder with shots/, photos/ and world.exr in
// it.
#include <cstdlib>
#include <regex>

#include "tests/cli/carpet_file.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

std::vector<std::string> runnable_lines(const std::string& readme) {
  std::vector<std::string> lines;
  std::istringstream text(readme);
  bool inside = false;
  for (std::string line; std::getline(text, line);) {
    if (line.rfind("```", 0) == 0) {
      inside = line == "```sh run";
    } else if (inside && !line.empty()) {
      lines.push_back(line);
    }
  }
  return lines;
}

/// Six photographs around, of something that can be matched.
void photograph_around(const ScratchDir& scratch) {
  write_carpet(scratch / "carpet.exr");
  std::filesystem::create_directories(scratch / "photos");
  for (int k = 0; k < 6; ++k) {
    const Path folder = scratch / ("turn" + std::to_string(k));
    answer_of({"simulate", (scratch / "carpet.exr").string(), "-o", folder.string(), "--fov", "85", "--size", "640x480",
               "--rotate", "0," + std::to_string(60 * k) + ",0", "--times", "1/60"});
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".jpg") {
        std::filesystem::rename(entry.path(), scratch / "photos" / (std::to_string(k) + ".jpg"));
      }
    }
  }
}

TEST(Readme, EveryCommandRuns) {
  const ScratchDir scratch;
  write_world(scratch / "world.exr");
  answer_of({"simulate", (scratch / "world.exr").string(), "-o", (scratch / "shots").string(), "--ball", "--size",
             "400x300", "--times", "1/1000,1/250,1/60,1/40,1/15,1/4"});
  photograph_around(scratch);
  const std::vector<std::string> lines = runnable_lines(bytes_of(std::string(HDR_SOURCE_DIR) + "/README.md"));
  ASSERT_GE(lines.size(), 10u) << "the README lost its runnable blocks";
  const std::string setting = "cd '" + scratch.path().string() + "' && PATH='" + HDR_BUILD_DIR + "':$PATH && ";
  for (const std::string& line : lines) {
    const CommandResult result = run_command({"bash", "-c", setting + line});
    EXPECT_EQ(result.exit_code, 0) << line << "\n" << result.err;
  }
}

TEST(Readme, ItsFilesAndFoldersExist) {
  const std::string readme = bytes_of(std::string(HDR_SOURCE_DIR) + "/README.md");
  const std::regex link(R"(\]\(([^)#:]+)\))");
  int links = 0;
  for (std::sregex_iterator it(readme.begin(), readme.end(), link), end; it != end; ++it, ++links) {
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(HDR_SOURCE_DIR) / (*it)[1].str())) << (*it)[1];
  }
  EXPECT_GE(links, 5);
}

}  // namespace
}  // namespace hdr::test
