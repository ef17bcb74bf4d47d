#include "tests/bench/rivals/programs.h"

#include <unistd.h>

#include <cstdlib>
#include <sstream>

#include "libhdr/core/error.h"
#include "tests/support/scratch.h"

namespace hdr::bench {

std::optional<Path> find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const Path file = Path(folder) / name;
    if (access(file.c_str(), X_OK) == 0 && !std::filesystem::is_directory(file)) return file;
  }
  return std::nullopt;
}

std::vector<std::unique_ptr<MergeProgram>> merge_programs() {
  std::vector<std::unique_ptr<MergeProgram>> programs;
  programs.push_back(pfstools());
  programs.push_back(luminance_hdr());
  return programs;
}

std::string shell_word(const Path& path) {
  std::string text = "'";
  for (const char c : path.string()) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

void run_shell(const std::string& line) {
  const support::ProgramResult result = support::run_program({"bash", "-o", "pipefail", "-c", line});
  if (result.exit_code == 0) return;
  std::string last;
  std::istringstream lines(result.err);
  for (std::string l; std::getline(lines, l);) {
    if (!l.empty()) last = l;
  }
  throw Error(line.substr(0, line.find(' ')) + " failed: " + last);
}

}  // namespace hdr::bench
