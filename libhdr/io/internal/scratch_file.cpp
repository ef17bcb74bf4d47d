#include "libhdr/io/internal/scratch_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "libhdr/core/error.h"

namespace hdr::internal {
namespace {

namespace fs = std::filesystem;

fs::path folder() {
  std::error_code failed;
  const fs::path named = fs::temp_directory_path(failed);
  return failed ? fs::path("/tmp") : named;
}

[[noreturn]] void fail(const std::string& purpose, const char* what) {
  throw Error(fmt::format("{}: a temporary file in {} {}: {}; set TMPDIR to a folder with room", purpose,
                          folder().string(), what, std::strerror(errno)));
}

}  // namespace

ScratchFile::ScratchFile(std::string purpose) : purpose_(std::move(purpose)) {
  std::string name = (folder() / "hdr-XXXXXX").string();
  file_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) fail(purpose_, "cannot be made");
  ::unlink(name.c_str());
}

ScratchFile::~ScratchFile() {
  ::close(file_);
}

void ScratchFile::append(const void* bytes, std::size_t count) {
  for (const char* from = static_cast<const char*>(bytes); count > 0;) {
    const ssize_t written = ::write(file_, from, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(purpose_, "cannot be written");
    from += written;
    count -= static_cast<std::size_t>(written);
  }
}

void ScratchFile::read_at(std::int64_t offset, void* bytes, std::size_t count) const {
  for (char* to = static_cast<char*>(bytes); count > 0;) {
    const ssize_t read = ::pread(file_, to, count, offset);
    if (read < 0 && errno == EINTR) continue;
    if (read <= 0) fail(purpose_, "cannot be read");
    to += read;
    offset += read;
    count -= static_cast<std::size_t>(read);
  }
}

}  // namespace hdr::internal
