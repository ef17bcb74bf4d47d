#include "libhdr/io/internal/file_kind.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/dng_file.h"

namespace hdr::internal {

using namespace std::string_view_literals;

FileKind kind_of(std::string_view bytes) {
  const auto is_space = [&](std::size_t k) { return bytes.size() > k && std::strchr(" \t\r\n#", bytes[k]) != nullptr; };
  if (bytes.starts_with("\xff\xd8"sv)) return FileKind::kJpeg;
  if (bytes.starts_with("\x89PNG\r\n\x1a\n"sv)) return FileKind::kPng;
  if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv)) return FileKind::kTiff;
  if (bytes.starts_with("II+\0"sv) || bytes.starts_with("MM\0+"sv)) return FileKind::kTiff;  // BigTIFF
  if (bytes.starts_with("\x76\x2f\x31\x01"sv)) return FileKind::kExr;
  if (bytes.starts_with("#?"sv)) return FileKind::kRadiance;
  if ((bytes.starts_with("PF"sv) || bytes.starts_with("Pf"sv)) && is_space(2)) return FileKind::kPfm;
  if (bytes.size() > 1 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6' && is_space(2)) return FileKind::kPnm;
  if (bytes.starts_with("RIFF"sv) && bytes.size() >= 12 && bytes.substr(8, 4) == "WEBP"sv) return FileKind::kWebp;
  if (bytes.size() >= 12 && bytes.substr(4, 4) == "ftyp"sv) return FileKind::kHeif;
  if (bytes.starts_with("BM"sv)) return FileKind::kBmp;
  return FileKind::kOther;
}

FileKind kind_of_file(const Path& path) {
  if (is_raw_name(path)) return FileKind::kRaw;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path.string() + ": cannot be read: " + std::strerror(errno) + "; check its permissions");
  std::string start(16, '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  return kind_of(start);
}

const char* oiio_reader_of(FileKind kind) {
  switch (kind) {
    case FileKind::kJpeg:
      return "jpeg";
    case FileKind::kPng:
      return "png";
    case FileKind::kTiff:
      return "tiff";
    case FileKind::kExr:
      return "openexr";
    case FileKind::kPnm:
      return "pnm";
    case FileKind::kWebp:
      return "webp";
    case FileKind::kHeif:
      return "heif";
    case FileKind::kBmp:
      return "bmp";
    default:
      return nullptr;
  }
}

double most_pixels_per_byte(FileKind kind) {
  constexpr double kDeflate = 1032;  // bytes out of one: the longest match, 258, in two bits
  switch (kind) {
    case FileKind::kJpeg:
      return 2048;  // a progressive scan may skip 16x16 pixels in an eighth of a byte
    case FileKind::kPng:
      return 8 * kDeflate;  // pixels of one bit
    case FileKind::kBmp:
    case FileKind::kPnm:
    case FileKind::kPfm:
      return 255;  // runs in BMP; the others pack nothing
    default:
      return 65536;
  }
}

}  // namespace hdr::internal
