#include "libhdr/io/internal/jpeg_markers.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/file_kind.h"

namespace hdr::internal {
namespace {

// ITU-T T.81, table B.1.
enum Marker : std::uint8_t {
  kStuffing = 0x00,  ///< FF00: the byte FF of entropy-coded data
  kDht = 0xc4,
  kSoi = 0xd8,
  kEoi = 0xd9,
  kSos = 0xda,
  kApp2 = 0xe2,
};
bool is_restart(std::uint8_t code) {
  return code >= 0xd0 && code <= 0xd7;
}

/// SOF0 to SOF15, but for DHT, JPG and DAC.
bool is_frame(std::uint8_t code) {
  return code >= 0xc0 && code <= 0xcf && code != kDht && code != 0xc8 && code != 0xcc;
}

constexpr char kIccSignature[] = "ICC_PROFILE";  // with its closing zero, 12 bytes, then chunk number and count

class MarkerWalk {
 public:
  explicit MarkerWalk(const std::string& bytes) : bytes_(bytes) {}

  /// True when the picture's end marker is reached through whole segments.
  bool reaches_end() {
    at_ = 2;  // after SOI
    while (const std::optional<std::uint8_t> code = next_marker()) {
      layout_.end = at_;
      if (*code == kEoi) return true;
      if (is_restart(*code) || *code == kSoi || *code == 0x01) continue;  // markers that stand alone
      if (*code == kSos) ++layout_.scans;
      if (*code == kDht) layout_.huffman_tables = true;
      if (is_frame(*code)) take_size();
      if (!skip_segment(*code)) return false;
    }
    return false;
  }
  bool icc_is_damaged() const { return icc_is_damaged_; }
  const JpegLayout& layout() const { return layout_; }

 private:
  std::uint8_t byte(std::size_t i) const { return static_cast<std::uint8_t>(bytes_[i]); }

  /// The code after the next FF that is neither stuffing nor fill; in entropy-coded data this skips the scan.
  std::optional<std::uint8_t> next_marker() {
    while (at_ + 1 < bytes_.size()) {
      const void* found = std::memchr(bytes_.data() + at_, 0xff, bytes_.size() - at_ - 1);
      if (!found) break;
      at_ = static_cast<std::size_t>(static_cast<const char*>(found) - bytes_.data()) + 1;
      if (byte(at_) != kStuffing && byte(at_) != 0xff) return byte(at_++);
    }
    return std::nullopt;
  }

  /// Length, precision, then height and width, two bytes each.
  void take_size() {
    if (at_ + 7 > bytes_.size()) return;
    layout_.height = byte(at_ + 3) * 256 + byte(at_ + 4);
    layout_.width = byte(at_ + 5) * 256 + byte(at_ + 6);
  }

  bool skip_segment(std::uint8_t code) {
    if (at_ + 2 > bytes_.size()) return false;
    const std::size_t length = byte(at_) * 256u + byte(at_ + 1);
    if (length < 2 || at_ + length > bytes_.size()) return false;
    if (code == kApp2) check_icc(at_ + 2, length - 2);
    at_ += length;
    return true;
  }

  /// An ICC profile comes in chunks numbered 1 to count.
  void check_icc(std::size_t begin, std::size_t length) {
    if (length < sizeof kIccSignature || std::memcmp(&bytes_[begin], kIccSignature, sizeof kIccSignature) != 0) return;
    layout_.profiles.push_back(begin);
    constexpr std::size_t kHead = sizeof kIccSignature + 2;
    if (length < kHead) {
      icc_is_damaged_ = true;
      return;
    }
    const int number = byte(begin + kHead - 2), count = byte(begin + kHead - 1);
    if (number < 1 || number > count) icc_is_damaged_ = true;
  }

  const std::string& bytes_;
  std::size_t at_ = 0;
  bool icc_is_damaged_ = false;
  JpegLayout layout_;
};

std::string slurp_if_jpeg(const Path& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file ? static_cast<std::streamoff>(file.tellg()) : 0;
  char start[2] = {};
  file.seekg(0);
  if (size < 2 || !file.read(start, 2) || start[0] != '\xff' || start[1] != '\xd8') return {};
  std::string bytes(static_cast<std::size_t>(size), '\0');
  file.seekg(0);
  file.read(bytes.data(), size);
  return bytes;
}

}  // namespace

std::optional<JpegLayout> vet_jpeg(const Path& path) {
  return vet_jpeg(slurp_if_jpeg(path), path.string());
}

std::optional<JpegLayout> vet_jpeg(const std::string& bytes, const std::string& name) {
  if (!bytes.starts_with("\xff\xd8")) return std::nullopt;
  MarkerWalk walk(bytes);
  if (!walk.reaches_end()) {
    throw Error(
        fmt::format("{}: truncated: the file stops after {} bytes, before the end of the picture; copy it "
                    "again from the camera",
                    name, bytes.size()));
  }
  if (walk.icc_is_damaged()) {
    throw Error(name + ": its colour profile (ICC) is damaged; save the picture again without it");
  }
  // Before libjpeg sees it: for a progressive picture it allocates the whole of it first.
  const JpegLayout& layout = walk.layout();
  if (1.0 * layout.width * layout.height > static_cast<double>(bytes.size()) * most_pixels_per_byte(FileKind::kJpeg)) {
    throw Error(fmt::format("{}: its header promises {} x {} pixels in {} bytes; is it damaged?", name, layout.width,
                            layout.height, bytes.size()));
  }
  return layout;
}

}  // namespace hdr::internal
