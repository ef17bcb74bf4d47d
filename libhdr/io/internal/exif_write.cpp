#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/exif.h"
#include "libhdr/io/output_file.h"

namespace hdr::internal {
namespace {

// EXIF is a TIFF structure (TIFF 6.0, section 2; EXIF 2.3, section 4.6), here always little endian.
constexpr std::uint16_t kExifDirectory = 0x8769, kExposureTime = 0x829a, kFNumber = 0x829d, kIso = 0x8827;
constexpr std::uint16_t kIsoSpeed = 0x8833;
constexpr std::uint16_t kShort = 3, kLong = 4, kRational = 5;
constexpr std::size_t kEntryBytes = 12;

void put(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>((value >> (8 * i)) & 0xff));
}
void put_big_endian(std::string& out, std::uint32_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<char>((value >> (8 * i)) & 0xff));
}
std::uint32_t get(const std::string& in, std::size_t at, int bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i) {
    value |= std::uint32_t{static_cast<std::uint8_t>(in.at(at + static_cast<std::size_t>(i)))} << (8 * i);
  }
  return value;
}
void put_entry(std::string& out, std::uint16_t tag, std::uint16_t type, std::uint32_t value) {
  put(out, tag, 2);
  put(out, type, 2);
  put(out, 1, 4);
  put(out, value, 4);
}

struct Rational {
  std::uint32_t numerator, denominator;
};

/// The convergents of the continued fraction come closest for their size; stop when the next one leaves 32 bits or the
/// value is met to double's precision.
Rational rational_from(double value) {
  constexpr double kMost = 4294967295.0;
  double n0 = 0, d0 = 1, n1 = 1, d1 = 0, rest = value;
  for (int step = 0; step < 40; ++step) {
    const double whole = std::floor(rest);
    const double n2 = whole * n1 + n0, d2 = whole * d1 + d0;
    if (n2 > kMost || d2 > kMost) break;
    n0 = n1, d0 = d1, n1 = n2, d1 = d2;
    if (std::abs(n1 / d1 - value) <= 1e-15 * value || rest == whole) break;
    rest = 1 / (rest - whole);
  }
  return {static_cast<std::uint32_t>(n1), static_cast<std::uint32_t>(std::max(d1, 1.0))};
}

/// The EXIF directory as it stands at offset `at` of its TIFF structure: count, entries, no next one, then rationals.
std::string exif_directory(const Exposure& exposure, std::size_t at) {
  const bool time = exposure.seconds.has_value(), aperture = exposure.f_number.has_value();
  const bool iso = exposure.iso.has_value();
  const auto iso_value =
      static_cast<std::uint32_t>(std::clamp(std::round(exposure.iso.value_or(0)), 0.0, 4294967295.0));
  const bool long_iso = iso_value >= 65535;
  const std::size_t entries = std::size_t{time} + aperture + iso + long_iso;
  auto rational_at = static_cast<std::uint32_t>(at + 2 + kEntryBytes * entries + 4);

  std::string out, rationals;
  const auto put_rational = [&](std::uint16_t tag, double value) {
    put_entry(out, tag, kRational, rational_at + static_cast<std::uint32_t>(rationals.size()));
    const Rational r = rational_from(value);
    put(rationals, r.numerator, 4);
    put(rationals, r.denominator, 4);
  };
  put(out, entries, 2);
  if (time) put_rational(kExposureTime, *exposure.seconds);
  if (aperture) put_rational(kFNumber, *exposure.f_number);
  if (iso) put_entry(out, kIso, kShort, std::min(iso_value, 65535u));
  if (long_iso) put_entry(out, kIsoSpeed, kLong, iso_value);
  put(out, 0, 4);
  return out + rationals;
}

/// A TIFF structure that holds nothing but a directory with one entry: where the EXIF directory is.
std::string exif_block(const Exposure& exposure) {
  std::string out("II*\0", 4);
  constexpr std::size_t kFirst = 8, kExif = kFirst + 2 + kEntryBytes + 4;
  put(out, kFirst, 4);
  put(out, 1, 2);
  put_entry(out, kExifDirectory, kLong, kExif);
  put(out, 0, 4);
  return out + exif_directory(exposure, kExif);
}

/// PNG: CRC-32 of the chunk's type and data (PNG 1.2, annex D).
std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char c : bytes) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

/// PNG: an eXIf chunk after IHDR, which is always the first and ends at byte 33.
std::string with_exif_chunk(const std::string& png, const Exposure& exposure) {
  constexpr std::size_t kAfterHeader = 33;
  const std::string body = exif_block(exposure), typed = "eXIf" + body;
  std::string chunk;
  put_big_endian(chunk, static_cast<std::uint32_t>(body.size()), 4);
  chunk += typed;
  put_big_endian(chunk, crc32(typed), 4);
  return png.substr(0, kAfterHeader) + chunk + png.substr(kAfterHeader);
}

/// TIFF: the first directory is written anew at the end with one entry more, then the EXIF directory it points to.
std::string with_exif_directory(std::string tiff, const Exposure& exposure) {
  if (tiff.size() % 2) tiff.push_back('\0');
  const std::size_t old_at = get(tiff, 4, 4), count = get(tiff, old_at, 2), new_at = tiff.size();
  const std::size_t exif_at = new_at + 2 + kEntryBytes * (count + 1) + 4;
  std::string exif_entry;
  put_entry(exif_entry, kExifDirectory, kLong, static_cast<std::uint32_t>(exif_at));
  std::string directory;
  put(directory, count + 1, 2);
  bool placed = false;
  for (std::size_t i = 0; i < count; ++i) {  // entries stand in rising order of their tags
    const std::string entry = tiff.substr(old_at + 2 + kEntryBytes * i, kEntryBytes);
    if (!placed && get(entry, 0, 2) > kExifDirectory) {
      directory += exif_entry;
      placed = true;
    }
    directory += entry;
  }
  if (!placed) directory += exif_entry;
  directory += tiff.substr(old_at + 2 + kEntryBytes * count, 4);  // the next picture, if any
  std::string offset;
  put(offset, new_at, 4);
  tiff.replace(4, 4, offset);
  return tiff + directory + exif_directory(exposure, exif_at);
}

}  // namespace

/// JPEG: an APP1 segment (EXIF 2.3, 4.5.4) among the leading APPn segments, in place of the empty one that
/// OpenImageIO writes.
std::string jpeg_with_exposure(const std::string& jpeg, const Exposure& exposure) {
  const std::string signature("Exif\0\0", 6), body = signature + exif_block(exposure);
  std::string segments;
  std::size_t at = 2;  // after SOI
  while (jpeg.at(at) == '\xff' && (get(jpeg, at + 1, 1) & 0xf0) == 0xe0) {
    const std::size_t bytes = 2 + get(jpeg, at + 2, 1) * 256u + get(jpeg, at + 3, 1);
    if (jpeg.compare(at + 4, signature.size(), signature) != 0) segments += jpeg.substr(at, bytes);
    at += bytes;
  }
  segments += "\xff\xe1";
  put_big_endian(segments, static_cast<std::uint32_t>(body.size() + 2), 2);
  return jpeg.substr(0, 2) + segments + body + jpeg.substr(at);
}

void embed_exposure(const Path& file, const Exposure& exposure) {
  if (!exposure.seconds && !exposure.f_number && !exposure.iso) return;
  const std::string bytes = read_text(file);
  if (bytes.starts_with("\xff\xd8")) return write_text(file, jpeg_with_exposure(bytes, exposure));
  if (bytes.starts_with("\x89PNG")) return write_text(file, with_exif_chunk(bytes, exposure));
  HDR_ASSERT(bytes.starts_with(std::string("II*\0", 4)));
  write_text(file, with_exif_directory(bytes, exposure));
}

}  // namespace hdr::internal
