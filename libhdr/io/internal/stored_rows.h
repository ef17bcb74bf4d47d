#pragma once
#include <OpenImageIO/imageio.h>

#include <cstdint>

#include "libhdr/core/image.h"
#include "libhdr/core/photo.h"

namespace hdr::internal {

/// 8 or 16; an Error for anything else.
int bits_of(const OIIO::ImageSpec& spec, const Path& path);

/// The rows of a picture file as stored (not yet upright), one after the other, as RGB: grey spread to three channels,
/// alpha and whatever else follows dropped. T is the file's own type of sample. Rows of three channels go from the
/// decoder straight into the caller's memory: as fast as the codec, without a copy in between.
template <class T>
class StoredRows {
 public:
  /// `input`, freshly opened, must outlive this.
  StoredRows(OIIO::ImageInput& input, Path path);
  /// Decodes the next row into `rgb`, room for width x 3 samples. Throws Error that names the row.
  void next(T* rgb);

 private:
  const T* next_in_tiles();

  OIIO::ImageInput& input_;
  Path path_;
  int next_ = 0;
  Image<T> raw_;  ///< one row of all channels, or one row of tiles
};

extern template class StoredRows<std::uint8_t>;
extern template class StoredRows<std::uint16_t>;

}  // namespace hdr::internal
