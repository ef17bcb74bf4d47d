#pragma once
// Other people's commands, from photographs in files to a map in a file. They are looked for when the benchmark runs.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"

namespace hdr::bench {

/// Where PATH has it.
std::optional<Path> find_program(const std::string& name);

/// Shots in files and what is known of them.
struct ShotFiles {
  std::vector<Path> files;
  std::vector<double> seconds;
};

class MergeProgram {
 public:
  virtual ~MergeProgram() = default;
  virtual std::string name() const = 0;
  virtual std::string program() const = 0;  ///< that PATH must have
  virtual std::string package() const = 0;  ///< of Debian, that has it
  /// Calibrates and merges registered sRGB photographs into `output` (.exr), with `scratch` for its own files. Throws
  /// Error when the program fails.
  virtual void run(const ShotFiles& shots, const Path& output, const Path& scratch) const = 0;
};

std::vector<std::unique_ptr<MergeProgram>> merge_programs();

std::unique_ptr<MergeProgram> pfstools();
std::unique_ptr<MergeProgram> luminance_hdr();

/// A line of bash in which any step that fails fails the line; throws Error with the last line of its stderr.
void run_shell(const std::string& line);

/// 'as a word for bash'.
std::string shell_word(const Path& path);

}  // namespace hdr::bench
