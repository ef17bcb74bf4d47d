#pragma once
#include <algorithm>

#include "libhdr/core/image.h"
#include "libhdr/core/parallel.h"

namespace hdr::internal {

/// Turns a picture upright from its EXIF orientation (TIFF 6.0: where row 0 and column 0 of the file lie):
///   1 as is   2 mirrored   3 half turn   4 upside down   5 transposed   6 turn clockwise   7 transverse   8 turn back
template <class T>
Image<T> upright(Image<T> stored, int orientation) {
  if (orientation <= 1 || orientation > 8) return stored;
  const bool on_its_side = orientation >= 5;
  const int w = stored.width(), h = stored.height(), channels = stored.channels();
  // In the upright picture, moving right and down moves so in the stored one:
  const bool from_right = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
  const bool from_bottom = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  Image<T> turned(on_its_side ? h : w, on_its_side ? w : h, channels);
  // A turned picture is read along its columns: strips of 32 rows keep both sides in the cache.
  for_rows(turned.height(), 32, [&](int first, int last) {
    for (int x = 0; x < turned.width(); ++x) {
      for (int y = first; y < last; ++y) {
        const int column = on_its_side ? y : x, row = on_its_side ? x : y;
        const T* from = stored.pixel(from_right ? w - 1 - column : column, from_bottom ? h - 1 - row : row);
        std::copy_n(from, channels, turned.pixel(x, y));
      }
    }
  });
  return turned;
}

}  // namespace hdr::internal
