#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <new>
#include <string>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/exif.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/orientation.h"
#include "libhdr/io/internal/photo_file.h"
#include "libhdr/io/read.h"

namespace hdr {
namespace internal {
namespace {

int bits_of(const OIIO::ImageSpec& spec, const Path& path) {
  if (spec.format == OIIO::TypeDesc::UINT8) return 8;
  if (spec.format == OIIO::TypeDesc::UINT16) return 16;
  if (spec.format.is_floating_point()) {
    throw Error(path.string() +
                ": a radiance map (float samples), not a photograph; give the camera's JPEG, PNG or TIFF");
  }
  throw Error(fmt::format("{}: samples of type {}; a photograph has 8 or 16 bits", path.string(), spec.format.c_str()));
}

/// Spreads grey to three channels, or drops alpha and whatever else follows RGB.
template <class T>
void rgb_from_samples(const T* samples, int channels, T* rgb, int width) {
  const bool grey = channels < 3;
  for (int x = 0; x < width; ++x) {
    for (int c = 0; c < 3; ++c) rgb[3 * x + c] = samples[channels * x + (grey ? 0 : c)];
  }
}

/// Each row goes from the decoder straight into our memory: as fast as the codec, without a copy in between.
template <class T>
Image<T> decode_rows(OIIO::ImageInput& input, const Path& path) {
  const OIIO::ImageSpec& spec = input.spec();
  Image<T> image(spec.width, spec.height, 3);
  if (spec.tile_width > 0) {
    Image<T> all(spec.width, spec.height, spec.nchannels);
    const bool read = input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc(OIIO::BaseTypeFromC<T>::value),
                                       all.row(0), static_cast<OIIO::stride_t>(sizeof(T)) * spec.nchannels,
                                       static_cast<OIIO::stride_t>(sizeof(T)) * all.stride());
    if (!read || input.has_error()) throw_unreadable(path, input);
    for (int y = 0; y < spec.height; ++y) rgb_from_samples(all.row(y), spec.nchannels, image.row(y), spec.width);
    return image;
  }
  Image<T> line(spec.nchannels == 3 ? 0 : spec.width, 1, spec.nchannels);
  for (int y = 0; y < spec.height; ++y) {
    T* row = spec.nchannels == 3 ? image.row(y) : line.row(0);
    if (!input.read_native_scanline(0, 0, spec.y + y, 0, row)) throw_unreadable(path, input);
    if (spec.nchannels != 3) rgb_from_samples<T>(row, spec.nchannels, image.row(y), spec.width);
  }
  return image;
}

}  // namespace

PhotoHeader decode_photo_header(const Path& path) {
  const auto input = open_picture(path);
  const OIIO::ImageSpec& spec = input->spec();
  return {path, upright_size(spec), bits_of(spec, path), is_lossy(*input), exposure_from_exif(*input, path)};
}

Photo decode_photo(const Path& path) {
  const auto input = open_picture(path);
  const OIIO::ImageSpec& spec = input->spec();
  Photo photo{path, exposure_from_exif(*input, path), bits_of(spec, path), is_lossy(*input), {}};
  const int orientation = orientation_of(spec);
  try {
    if (photo.bits == 8) {
      photo.codes = upright(decode_rows<std::uint8_t>(*input, path), orientation);
    } else {
      photo.codes = upright(decode_rows<std::uint16_t>(*input, path), orientation);
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
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

}  // namespace hdr
