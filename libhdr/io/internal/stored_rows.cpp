#include "libhdr/io/internal/stored_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/oiio.h"

namespace hdr::internal {
namespace {

template <class T>
void rgb_from_samples(const T* samples, int channels, T* rgb, int width) {
  const bool grey = channels < 3;
  for (int x = 0; x < width; ++x) {
    for (int c = 0; c < 3; ++c) rgb[3 * x + c] = samples[channels * x + (grey ? 0 : c)];
  }
}

}  // namespace

int bits_of(const OIIO::ImageSpec& spec, const Path& path) {
  if (spec.format == OIIO::TypeDesc::UINT8) return 8;
  if (spec.format == OIIO::TypeDesc::UINT16) return 16;
  if (spec.format.is_floating_point()) {
    throw Error(path.string() +
                ": a radiance map (float samples), not a photograph; give the camera's JPEG, PNG or TIFF");
  }
  throw Error(fmt::format("{}: samples of type {}; a photograph has 8 or 16 bits", path.string(), spec.format.c_str()));
}

template <class T>
StoredRows<T>::StoredRows(OIIO::ImageInput& input, Path path) : input_(input), path_(std::move(path)) {
  const OIIO::ImageSpec& spec = input.spec();
  if (spec.tile_width > 0) {
    raw_ = Image<T>(spec.width, std::min(spec.height, spec.tile_height), spec.nchannels);
  } else if (spec.nchannels != 3) {
    raw_ = Image<T>(spec.width, 1, spec.nchannels);
  }
}

template <class T>
const T* StoredRows<T>::next_in_tiles() {
  const OIIO::ImageSpec& spec = input_.spec();
  const int row_of_tile = next_ % spec.tile_height;
  if (row_of_tile == 0) {
    const int last = std::min(spec.height, next_ + spec.tile_height);
    const auto step = static_cast<OIIO::stride_t>(sizeof(T));
    const bool read = input_.read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + next_, spec.y + last, spec.z,
                                        spec.z + 1, 0, spec.nchannels, OIIO::TypeDesc(OIIO::BaseTypeFromC<T>::value),
                                        raw_.row(0), step * spec.nchannels, step * raw_.stride());
    if (!read || input_.has_error()) throw_unreadable(path_, input_, next_);
  }
  return raw_.row(row_of_tile);
}

template <class T>
void StoredRows<T>::next(T* rgb) {
  const OIIO::ImageSpec& spec = input_.spec();
  const T* samples = nullptr;
  if (spec.tile_width > 0) {
    samples = next_in_tiles();
  } else {
    T* row = spec.nchannels == 3 ? rgb : raw_.row(0);
    // The decoder of a truncated TIFF may say that it has read, and leave an error.
    if (!input_.read_native_scanline(0, 0, spec.y + next_, 0, row) || input_.has_error()) {
      throw_unreadable(path_, input_, next_);
    }
    samples = row;
  }
  if (samples != rgb) rgb_from_samples(samples, spec.nchannels, rgb, spec.width);
  ++next_;
}

template class StoredRows<std::uint8_t>;
template class StoredRows<std::uint16_t>;

}  // namespace hdr::internal
