#pragma once
// Scratch folders and running programs, with nothing of GoogleTest: for benchmarks, and what support.h stands on.
#include <filesystem>
#include <string>
#include <vector>

namespace hdr::support {

/// A fresh empty folder, left to whoever asked.
std::filesystem::path new_scratch_folder();

/// A fresh empty folder, removed at the end.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

struct ProgramResult {
  int exit_code = -1;  ///< 128 + signal when killed
  std::string out, err;
};
/// Runs a program without a shell.
ProgramResult run_program(const std::vector<std::string>& arguments);

}  // namespace hdr::support
