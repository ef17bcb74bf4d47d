#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/exif.h"
#include "libhdr/io/output_file.h"

namespace hdr::internal {
namespace {

// EXIF is a TIFF structure (TIFF 6.0, section 2; EXIF 2.3, section 4.6), here always little endian.
constexpr std::uint16_t kExifDirectory = 0x8769, kExposureTime = 0x829a, kFNumber = 0x829d, kIso = 0x8827;
constexpr std::uint16_t kIsoSpeed = 0x8833, kFocalLength = 0x920a, kPixelXDimension = 0xa002, kPixelYDimension = 0xa003;
constexpr std::uint16_t kFocalPlaneXResolution = 0xa20e, kFocalPlaneYResolution = 0xa20f;
constexpr std::uint16_t kFocalPlaneResolutionUnit = 0xa210;
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

/// What goes into the EXIF directory, its tags rising.
struct Field {
  std::uint16_t tag, type;
  double value;
};

std::vector<Field> fields_of(const Exposure& exposure, const std::optional<Lens>& lens) {
  std::vector<Field> fields;
  if (exposure.seconds) fields.push_back({kExposureTime, kRational, *exposure.seconds});
  if (exposure.f_number) fields.push_back({kFNumber, kRational, *exposure.f_number});
  if (exposure.iso) {
    const double iso = std::clamp(std::round(*exposure.iso), 0.0, 4294967295.0);
    fields.push_back({kIso, kShort, std::min(iso, 65535.0)});
    if (iso >= 65535) fields.push_back({kIsoSpeed, kLong, iso});
  }
  if (!lens) return fields;
  constexpr double kSensorCm = 3.6;
  const double focal_mm = 5 * kSensorCm / std::tan(lens->fov_degrees * std::numbers::pi / 360);
  fields.push_back({kFocalLength, kRational, focal_mm});
  fields.push_back({kPixelXDimension, kLong, static_cast<double>(lens->size.width)});
  fields.push_back({kPixelYDimension, kLong, static_cast<double>(lens->size.height)});
  fields.push_back({kFocalPlaneXResolution, kRational, lens->size.width / kSensorCm});
  fields.push_back({kFocalPlaneYResolution, kRational, lens->size.width / kSensorCm});
  fields.push_back({kFocalPlaneResolutionUnit, kShort, 3});
  return fields;
}

/// The EXIF directory as it stands at offset `at` of its TIFF structure: count, entries, no next one, then rationals.
std::string exif_directory(const std::vector<Field>& fields, std::size_t at) {
  const auto rational_at = static_cast<std::uint32_t>(at + 2 + kEntryBytes * fields.size() + 4);
  std::string out, rationals;
  put(out, fields.size(), 2);
  for (const Field& field : fields) {
    if (field.type != kRational) {
      put_entry(out, field.tag, field.type, static_cast<std::uint32_t>(field.value));
      continue;
    }
    put_entry(out, field.tag, kRational, rational_at + static_cast<std::uint32_t>(rationals.size()));
    const Rational r = rational_from(field.value);
    put(rationals, r.numerator, 4);
    put(rationals, r.denominator, 4);
  }
  put(out, 0, 4);
  return out + rationals;
}

/// A TIFF structure that holds nothing but a directory with one entry: where the EXIF directory is.
std::string exif_block(const std::vector<Field>& fields) {
  std::string out("II*\0", 4);
  constexpr std::size_t kFirst = 8, kExif = kFirst + 2 + kEntryBytes + 4;
  put(out, kFirst, 4);
  put(out, 1, 2);
  put_entry(out, kExifDirectory, kLong, kExif);
  put(out, 0, 4);
  return out + exif_directory(fields, kExif);
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
std::string with_exif_chunk(const std::string& png, const std::vector<Field>& fields) {
  constexpr std::size_t kAfterHeader = 33;
  const std::string body = exif_block(fields), typed = "eXIf" + body;
  std::string chunk;
  put_big_endian(chunk, static_cast<std::uint32_t>(body.size()), 4);
  chunk += typed;
  put_big_endian(chunk, crc32(typed), 4);
  return png.substr(0, kAfterHeader) + chunk + png.substr(kAfterHeader);
}

/// TIFF: the first directory is written anew at the end with one entry more, then the EXIF directory it points to.
std::string with_exif_directory(std::string tiff, const std::vector<Field>& fields) {
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
  return tiff + directory + exif_directory(fields, exif_at);
}

/// JPEG: an APP1 segment (EXIF 2.3, 4.5.4) among the leading APPn segments, in place of the empty one that
/// OpenImageIO writes.
std::string with_exif_segment(const std::string& jpeg, const std::vector<Field>& fields) {
  const std::string signature("Exif\0\0", 6), body = signature + exif_block(fields);
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

}  // namespace

std::string jpeg_with_exposure(const std::string& jpeg, const Exposure& exposure) {
  return with_exif_segment(jpeg, fields_of(exposure, {}));
}

void embed_exif(const Path& file, const Exposure& exposure, const std::optional<Lens>& lens) {
  const std::vector<Field> fields = fields_of(exposure, lens);
  if (fields.empty()) return;
  const std::string bytes = read_text(file);
  if (bytes.starts_with("\xff\xd8")) return write_text(file, with_exif_segment(bytes, fields));
  if (bytes.starts_with("\x89PNG")) return write_text(file, with_exif_chunk(bytes, fields));
  HDR_ASSERT(bytes.starts_with(std::string("II*\0", 4)));
  write_text(file, with_exif_directory(bytes, fields));
}

}  // namespace hdr::internal
