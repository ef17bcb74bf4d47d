#pragma once
// What tests share: real data (absent on a stranger's machine), scratch folders, running the command.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/image.h"

namespace hdr::test {

/// A file of the photograph collection beside the project, if it is there.
std::optional<std::filesystem::path> shared_data(const std::string& name);

/// A fresh empty folder, removed at the end.
class ScratchDir {
 public:
  ScratchDir();
  ~ScratchDir();
  ScratchDir(const ScratchDir&) = delete;
  ScratchDir& operator=(const ScratchDir&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

struct CommandResult {
  int exit_code = -1;  ///< 128 + signal when killed
  std::string out, err;
};
/// Runs a program without a shell.
CommandResult run_command(const std::vector<std::string>& arguments);
/// Runs the hdr command of this build.
CommandResult run_hdr(std::vector<std::string> arguments);

/// A seeded scene with `stops` stops of range, smooth gradients, edges and texture: width x height x 3, median near 1.
Image<float> test_scene(int width, int height, double stops, std::uint64_t seed);

}  // namespace hdr::test

/// Skips, visibly, when the collection of photographs is absent.
#define HDR_NEED_SHARED_DATA(variable, name)                                            \
  const auto variable##_found = ::hdr::test::shared_data(name);                         \
  if (!variable##_found) GTEST_SKIP() << "../shared/data/" << (name) << " is not here"; \
  const std::filesystem::path variable = *variable##_found
