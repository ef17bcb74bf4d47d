#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <new>
#include <string>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/dng_file.h"
#include "libhdr/io/internal/exif.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/orientation.h"
#include "libhdr/io/internal/photo_file.h"
#include "libhdr/io/internal/stored_rows.h"
#include "libhdr/io/read.h"

namespace hdr {
namespace internal {
namespace {

/// The upright picture. A turned one is put in its place strip by strip: it is never in memory twice.
template <class T>
Image<T> decode_rows(OIIO::ImageInput& input, const Path& path) {
  const Size stored{input.spec().width, input.spec().height};
  const Orientation orientation(orientation_of(input.spec()));
  Image<T> image(orientation.upright(stored), 3);
  StoredRows<T> rows(input, path);
  if (orientation.as_is()) {
    for (int y = 0; y < stored.height; ++y) rows.next(image.row(y));
    return image;
  }
  constexpr int kStrip = 32;
  Image<T> strip(stored.width, std::min(kStrip, stored.height), 3);
  for (int y = 0; y < stored.height; y += kStrip) {
    const int count = std::min(kStrip, stored.height - y);
    for (int k = 0; k < count; ++k) rows.next(strip.row(k));
    place_upright<T>(strip.view().rows(0, count), y, stored, orientation, image.view());
  }
  return image;
}

}  // namespace

PhotoHeader decode_photo_header(const Path& path) {
  const auto input = open_picture(path);
  const OIIO::ImageSpec& spec = input->spec();
  PhotoHeader header{path, upright_size(spec), bits_of(spec, path), is_lossy(*input), exposure_from_exif(*input, path)};
  if (const auto field = field_from_exif(*input, header.size)) {
    header.fov_degrees = field->degrees;
    header.fov_by_sensor = field->by_sensor;
  }
  return header;
}

Photo decode_photo(const Path& path) {
  const auto input = open_picture(path);
  const OIIO::ImageSpec& spec = input->spec();
  Photo photo{path, exposure_from_exif(*input, path), bits_of(spec, path), is_lossy(*input), {}, {}};
  require_memory(path, spec.width, spec.height, 3.0 * photo.bits / 8);
  try {
    if (photo.bits == 8) {
      photo.codes = decode_rows<std::uint8_t>(*input, path);
    } else {
      photo.codes = decode_rows<std::uint16_t>(*input, path);
    }
  } catch (const std::bad_alloc&) {
    throw Error(
        fmt::format("{}: {} x {} pixels do not fit in memory; scale it down", path.string(), spec.width, spec.height));
  }
  return photo;
}

}  // namespace internal

Photo read_photo(const Path& path) {
  Photo photo = internal::decode_photo(path);
  internal::require_usable_time(path, photo.exposure);
  return photo;
}

PhotoHeader read_photo_header(const Path& path) {
  PhotoHeader header = internal::decode_photo_header(path);
  internal::require_usable_time(path, header.exposure);
  return header;
}

bool is_photo_name(const Path& path) {
  static constexpr std::array kExtensions = {".jpg",  ".jpeg", ".jpe", ".png", ".tif", ".tiff", ".webp",
                                             ".heic", ".heif", ".bmp", ".ppm", ".pgm", ".pnm"};
  const std::string extension = internal::extension_of(path);
  return internal::is_raw_name(path) ||
         std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

}  // namespace hdr
