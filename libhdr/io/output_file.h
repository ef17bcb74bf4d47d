#pragma once
// Nothing is lost: a file is written under a temporary name beside its target and renamed when complete, so that a
// killed run leaves the old file or none, never half of one.
#include <string>

#include "libhdr/core/photo.h"

namespace hdr {

class OutputFile {
 public:
  /// Chooses the temporary name `.NAME.PID.tmp.EXT` in the target's folder (same extension, since writers choose the
  /// format by it). Throws Error when the folder does not exist or cannot be written.
  explicit OutputFile(Path target);
  ~OutputFile();  ///< removes the temporary file unless commit() was reached
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const Path& temporary() const { return temporary_; }
  void commit();  ///< renames the temporary file into place; throws Error

 private:
  Path target_, temporary_;
  bool committed_ = false;
};

/// Writes a text file whole, through OutputFile.
void write_text(const Path& path, const std::string& text);
/// Reads a text file whole; throws Error.
std::string read_text(const Path& path);

}  // namespace hdr
