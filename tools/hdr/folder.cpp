#include "tools/hdr/folder.h"

#include <filesystem>

#include "libhdr/core/error.h"

namespace hdr::tools {

void make_folder(const Path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw Error(folder.string() + ": cannot make this folder (" + failed.message() + "); pass another -o");
}

}  // namespace hdr::tools
