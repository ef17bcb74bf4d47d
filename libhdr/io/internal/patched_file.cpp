#include "libhdr/io/internal/patched_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>
#include <utility>

#include "libhdr/core/error.h"

namespace hdr::internal {
namespace {

/// A file opened for reading at any place.
class Bytes {
 public:
  explicit Bytes(const Path& path) : name_(path.string()), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat status {};
    if (file_ < 0 || ::fstat(file_, &status) != 0) {
      const std::string reason = std::strerror(errno);
      if (file_ >= 0) ::close(file_);
      throw Error(name_ + ": cannot be read: " + reason + "; check its permissions");
    }
    size_ = status.st_size;
  }
  ~Bytes() { ::close(file_); }
  Bytes(const Bytes&) = delete;
  Bytes& operator=(const Bytes&) = delete;

  std::int64_t size() const { return size_; }
  std::size_t read_at(std::int64_t offset, void* to, std::size_t count) const {
    if (offset < 0) return 0;
    const ssize_t read = ::pread(file_, to, count, offset);
    return static_cast<std::size_t>(std::max<ssize_t>(0, read));
  }
  /// `count` bytes as a number.
  std::uint64_t number(std::int64_t offset, int count, bool big_endian, const char* what) const {
    unsigned char raw[8];
    if (read_at(offset, raw, static_cast<std::size_t>(count)) != static_cast<std::size_t>(count)) {
      throw Error(fmt::format("{}: truncated: {} should be at byte {} of {}; copy it again from where it came", name_,
                              what, offset, size_));
    }
    std::uint64_t value = 0;
    for (int k = 0; k < count; ++k) value = value << 8 | raw[big_endian ? k : count - 1 - k];
    return value;
  }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  int file_;
  std::int64_t size_ = 0;
};

class PatchedFile final : public OIIO::Filesystem::IOProxy {
 public:
  PatchedFile(const Path& path, std::vector<Patch> patches)
      : IOProxy(path.string(), Read), bytes_(path), patches_(std::move(patches)) {}
  const char* proxytype() const override { return "patched"; }
  void close() override {}
  std::size_t read(void* to, std::size_t count) override {
    const std::size_t got = pread(to, count, m_pos);
    m_pos += static_cast<std::int64_t>(got);
    return got;
  }
  std::size_t pread(void* to, std::size_t count, std::int64_t offset) override {
    std::size_t got = 0;  // one call of the system may give less
    for (std::size_t more = 1; got < count && more > 0; got += more) {
      more = bytes_.read_at(offset + static_cast<std::int64_t>(got), static_cast<char*>(to) + got, count - got);
    }
    for (const Patch& patch : patches_) {
      const std::int64_t at = patch.offset - offset;
      if (at >= 0 && at < static_cast<std::int64_t>(got)) static_cast<char*>(to)[at] = patch.value;
    }
    return got;
  }
  std::size_t size() const override { return static_cast<std::size_t>(bytes_.size()); }

 private:
  Bytes bytes_;
  std::vector<Patch> patches_;
};

}  // namespace

std::unique_ptr<OIIO::Filesystem::IOProxy> patched_file(const Path& path, std::vector<Patch> patches) {
  return std::make_unique<PatchedFile>(path, std::move(patches));
}

std::vector<Patch> patches_of_tiff(const Path& path) {
  const Bytes file(path);
  const bool big_endian = file.number(0, 1, true, "the byte order") == 'M';
  const bool big_tiff = file.number(2, 2, big_endian, "the version") == 43;
  // TIFF 6.0: count, entries, offset of the next directory. BigTIFF has 64-bit offsets and counts.
  const int offset_bytes = big_tiff ? 8 : 4, count_bytes = big_tiff ? 8 : 2, entry_bytes = big_tiff ? 20 : 12;
  std::vector<Patch> patches;
  std::set<std::int64_t> visited;
  auto at = static_cast<std::int64_t>(file.number(big_tiff ? 8 : 4, offset_bytes, big_endian, "the first directory"));
  while (at != 0 && visited.insert(at).second) {
    const std::uint64_t entries = file.number(at, count_bytes, big_endian, "a directory");
    constexpr std::uint64_t kMost = 65535;
    if (entries > kMost) throw Error(fmt::format("{}: a directory of {} tags; is it damaged?", file.name(), entries));
    for (std::uint64_t k = 0; k < entries; ++k) {
      const std::int64_t tag_at = at + count_bytes + static_cast<std::int64_t>(k) * entry_bytes;
      constexpr std::uint64_t kIccProfile = 34675;  // 0x8773; the tag below it, 0x8772, means nothing
      if (file.number(tag_at, 2, big_endian, "a tag") == kIccProfile)
        patches.push_back({tag_at + (big_endian ? 1 : 0), 0x72});
    }
    const std::int64_t next_at = at + count_bytes + static_cast<std::int64_t>(entries) * entry_bytes;
    at = static_cast<std::int64_t>(file.number(next_at, offset_bytes, big_endian, "the next directory"));
  }
  return patches;
}

std::vector<Patch> patches_of_png(const Path& path) {
  const Bytes file(path);
  std::vector<Patch> patches;
  constexpr std::int64_t kSignature = 8;
  constexpr std::uint64_t kIccp = 0x69434350, kEnd = 0x49454e44;  // "iCCP", "IEND"
  for (std::int64_t at = kSignature; at + 12 <= file.size();) {   // where it is cut off, the reader says in which row
    const std::uint64_t length = file.number(at, 4, true, "a chunk"), type = file.number(at + 4, 4, true, "a chunk");
    if (type == kEnd) break;
    if (type == kIccp) patches.push_back({at + 4, 'x'});  // an ancillary chunk nobody knows: passed over
    at += 12 + static_cast<std::int64_t>(length);
  }
  return patches;
}

}  // namespace hdr::internal
