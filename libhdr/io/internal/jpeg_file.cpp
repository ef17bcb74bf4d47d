#include "libhdr/io/internal/jpeg_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

#include "libhdr/core/error.h"

namespace hdr::internal {
namespace {

/// The bytes of the file, but for the first letter of each profile's signature.
class Bytes {
 public:
  Bytes(const Path& path, std::vector<std::size_t> profiles) : profiles_(std::move(profiles)) {
    file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (file_ < 0 || ::fstat(file_, &status) != 0) {
      const std::string reason = std::strerror(errno);
      if (file_ >= 0) ::close(file_);
      throw Error(path.string() + ": cannot be read: " + reason + "; check its permissions");
    }
    size_ = status.st_size;
  }
  ~Bytes() { ::close(file_); }
  Bytes(const Bytes&) = delete;
  Bytes& operator=(const Bytes&) = delete;

  ssize_t read_at(char* to, std::size_t count, std::int64_t offset) const {
    const ssize_t read = ::pread(file_, to, count, offset);
    for (const std::size_t profile : profiles_) {
      const auto at = static_cast<std::int64_t>(profile) - offset;
      if (at >= 0 && at < read) to[at] = 'x';
    }
    return read;
  }
  std::int64_t size() const { return size_; }

 private:
  int file_ = -1;
  std::int64_t size_ = 0;
  std::vector<std::size_t> profiles_;
};

/// libjpeg wants a FILE: this one reads from Bytes.
struct Cursor {
  const Bytes& bytes;
  std::int64_t at = 0;
};

ssize_t read_on(void* cookie, char* to, std::size_t count) {
  auto& cursor = *static_cast<Cursor*>(cookie);
  const ssize_t read = cursor.bytes.read_at(to, count, cursor.at);
  cursor.at += std::max<ssize_t>(0, read);
  return read;
}

int seek_to(void* cookie, off64_t* offset, int whence) {
  auto& cursor = *static_cast<Cursor*>(cookie);
  const std::int64_t from = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? cursor.at : cursor.bytes.size();
  if (from + *offset < 0) return -1;
  *offset = cursor.at = from + *offset;
  return 0;
}

struct Stream {
  Stream(const Path& path, std::vector<std::size_t> profiles) : bytes(path, std::move(profiles)) {
    file = ::fopencookie(&cursor, "r", {read_on, nullptr, seek_to, nullptr});
    if (!file) throw Error(path.string() + ": cannot be read: " + std::strerror(errno) + "; close other programs");
  }
  ~Stream() { std::fclose(file); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  Bytes bytes;
  Cursor cursor{bytes};
  FILE* file = nullptr;
};

/// OpenImageIO's JPEG reader takes IOFile by its FILE, and nothing else that is not all in memory.
class JpegFile final : private Stream, public OIIO::Filesystem::IOFile {
 public:
  JpegFile(const Path& path, std::vector<std::size_t> profiles)
      : Stream(path, std::move(profiles)), IOFile(Stream::file, Read) {}
  /// IOFile's own asks for a file descriptor, which a FILE of this kind does not have.
  std::size_t pread(void* to, std::size_t count, std::int64_t offset) override {
    const ssize_t read = offset < 0 ? 0 : bytes.read_at(static_cast<char*>(to), count, offset);
    return static_cast<std::size_t>(std::max<ssize_t>(0, read));
  }
};

}  // namespace

std::unique_ptr<OIIO::Filesystem::IOProxy> jpeg_without_profiles(const Path& path, std::vector<std::size_t> profiles) {
  return std::make_unique<JpegFile>(path, std::move(profiles));
}

}  // namespace hdr::internal
