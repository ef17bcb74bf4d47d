// JPEG as cameras stream it (Motion JPEG).
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <string>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/exif.h"
#include "libhdr/io/internal/jpeg_markers.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/stored_rows.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"

namespace hdr {
namespace {

using namespace std::string_literals;

/// The tables that a stream without tables means: ITU-T T.81, tables K.3 to K.6. A table is 16 counts of codes by
/// length, then their values.
std::string standard_huffman_segment() {
  const std::string dc_values = "\x00\x01\x02\x03\x04\x05\x06\x07\x08\x09\x0a\x0b"s;
  const std::string tables =
      "\x00"s + "\x00\x01\x05\x01\x01\x01\x01\x01\x01\x00\x00\x00\x00\x00\x00\x00"s + dc_values + "\x01"s +
      "\x00\x03\x01\x01\x01\x01\x01\x01\x01\x01\x01\x00\x00\x00\x00\x00"s + dc_values + "\x10"s +
      "\x00\x02\x01\x03\x03\x02\x04\x03\x05\x05\x04\x04\x00\x00\x01\x7d"s +
      "\x01\x02\x03\x00\x04\x11\x05\x12\x21\x31\x41\x06\x13\x51\x61\x07\x22\x71\x14\x32\x81\x91\xa1\x08\x23\x42\xb1"
      "\xc1\x15\x52\xd1\xf0\x24\x33\x62\x72\x82\x09\x0a\x16\x17\x18\x19\x1a\x25\x26\x27\x28\x29\x2a\x34\x35\x36\x37"
      "\x38\x39\x3a\x43\x44\x45\x46\x47\x48\x49\x4a\x53\x54\x55\x56\x57\x58\x59\x5a\x63\x64\x65\x66\x67\x68\x69\x6a"
      "\x73\x74\x75\x76\x77\x78\x79\x7a\x83\x84\x85\x86\x87\x88\x89\x8a\x92\x93\x94\x95\x96\x97\x98\x99\x9a\xa2\xa3"
      "\xa4\xa5\xa6\xa7\xa8\xa9\xaa\xb2\xb3\xb4\xb5\xb6\xb7\xb8\xb9\xba\xc2\xc3\xc4\xc5\xc6\xc7\xc8\xc9\xca\xd2\xd3"
      "\xd4\xd5\xd6\xd7\xd8\xd9\xda\xe1\xe2\xe3\xe4\xe5\xe6\xe7\xe8\xe9\xea\xf1\xf2\xf3\xf4\xf5\xf6\xf7\xf8\xf9\xfa"s +
      "\x11"s + "\x00\x02\x01\x02\x04\x04\x03\x04\x07\x05\x04\x04\x00\x01\x02\x77"s +
      "\x00\x01\x02\x03\x11\x04\x05\x21\x31\x06\x12\x41\x51\x07\x61\x71\x13\x22\x32\x81\x08\x14\x42\x91\xa1\xb1\xc1"
      "\x09\x23\x33\x52\xf0\x15\x62\x72\xd1\x0a\x16\x24\x34\xe1\x25\xf1\x17\x18\x19\x1a\x26\x27\x28\x29\x2a\x35\x36"
      "\x37\x38\x39\x3a\x43\x44\x45\x46\x47\x48\x49\x4a\x53\x54\x55\x56\x57\x58\x59\x5a\x63\x64\x65\x66\x67\x68\x69"
      "\x6a\x73\x74\x75\x76\x77\x78\x79\x7a\x82\x83\x84\x85\x86\x87\x88\x89\x8a\x92\x93\x94\x95\x96\x97\x98\x99\x9a"
      "\xa2\xa3\xa4\xa5\xa6\xa7\xa8\xa9\xaa\xb2\xb3\xb4\xb5\xb6\xb7\xb8\xb9\xba\xc2\xc3\xc4\xc5\xc6\xc7\xc8\xc9\xca"
      "\xd2\xd3\xd4\xd5\xd6\xd7\xd8\xd9\xda\xe2\xe3\xe4\xe5\xe6\xe7\xe8\xe9\xea\xf2\xf3\xf4\xf5\xf6\xf7\xf8\xf9\xfa"s;
  constexpr std::size_t kLengthField = 2;
  const std::size_t length = tables.size() + kLengthField;
  return "\xff\xc4"s + static_cast<char>(length >> 8) + static_cast<char>(length & 0xff) + tables;
}

/// Where the application's segments (APPn) end: JFIF and EXIF must come before all others.
std::size_t end_of_app_segments(const std::string& jpeg) {
  const auto byte = [&](std::size_t i) { return std::size_t{static_cast<std::uint8_t>(jpeg[i])}; };
  std::size_t at = 2;  // after SOI; the walk has seen that all segments are whole
  while (byte(at) == 0xff && (byte(at + 1) & 0xf0) == 0xe0) at += 2 + 256 * byte(at + 2) + byte(at + 3);
  return at;
}

internal::JpegLayout vetted(const std::string& bytes, const std::string& name) {
  const std::optional<internal::JpegLayout> layout = internal::vet_jpeg(bytes, name);
  if (!layout) throw Error(name + ": not a JPEG; ask the camera for another format");
  return *layout;
}

}  // namespace

Photo photo_from_jpeg(std::span<const std::uint8_t> jpeg, const std::string& name) {
  std::string bytes(jpeg.begin(), jpeg.end());
  // OpenImageIO crashes on some ICC profiles (internal/jpeg_file.h): it shall not recognise them.
  for (const std::size_t profile : vetted(bytes, name).profiles) bytes[profile] = 'x';
  OIIO::Filesystem::IOMemReader file(bytes.data(), bytes.size());
  const auto input = OIIO::ImageInput::open("streamed.jpg", nullptr, &file);
  if (!input) {
    throw Error(fmt::format("{}: not a picture that can be read: {}; ask the camera for another format", name,
                            internal::oiio_message(OIIO::geterror(), name)));
  }
  const OIIO::ImageSpec& spec = input->spec();
  Image<std::uint8_t> codes(spec.width, spec.height, 3);
  internal::StoredRows<std::uint8_t> rows(*input, name);
  for (int y = 0; y < spec.height; ++y) rows.next(codes.row(y));
  return {{}, {}, 8, true, std::move(codes), {}};
}

void write_jpeg(const Path& path, std::span<const std::uint8_t> jpeg, const Exposure& exposure) {
  std::string bytes(jpeg.begin(), jpeg.end());
  const internal::JpegLayout layout = vetted(bytes, path.string());
  bytes.resize(layout.end);
  if (!layout.huffman_tables) bytes.insert(end_of_app_segments(bytes), standard_huffman_segment());
  write_text(path, internal::jpeg_with_exposure(bytes, exposure));
}

}  // namespace hdr
