#include "tests/support/support.h"

#include "tests/support/scratch.h"

namespace hdr::test {
namespace fs = std::filesystem;

std::optional<fs::path> shared_data(const std::string& name) {
  fs::path path = fs::path(HDR_SHARED_DATA) / name;
  if (!fs::exists(path)) return std::nullopt;
  return path;
}

ScratchDir::ScratchDir() : path_(support::new_scratch_folder()) {}

ScratchDir::~ScratchDir() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

CommandResult run_command(const std::vector<std::string>& arguments) {
  support::ProgramResult result = support::run_program(arguments);
  return {result.exit_code, std::move(result.out), std::move(result.err)};
}

CommandResult run_hdr(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), HDR_BINARY);
  return run_command(arguments);
}

}  // namespace hdr::test
