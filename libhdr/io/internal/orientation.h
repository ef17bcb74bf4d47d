#pragma once
#include <algorithm>

#include "libhdr/core/image.h"
#include "libhdr/core/parallel.h"

namespace hdr::internal {

/// EXIF orientation (TIFF 6.0: where row 0 and column 0 of the file lie):
///   1 as is   2 mirrored   3 half turn   4 upside down   5 transposed   6 turn clockwise   7 transverse   8 turn back
/// The upright picture's rows are the stored one's columns when it lies on its side; and moving right and down in the
/// upright picture moves away from these borders of the stored one.
struct Orientation {
  explicit Orientation(int exif)
      : on_its_side(exif >= 5 && exif <= 8),
        from_right(exif == 2 || exif == 3 || exif == 7 || exif == 8),
        from_bottom(exif == 3 || exif == 4 || exif == 6 || exif == 7) {}
  bool on_its_side, from_right, from_bottom;
  bool as_is() const { return !on_its_side && !from_right && !from_bottom; }
  Size upright(Size stored) const { return on_its_side ? Size{stored.height, stored.width} : stored; }
};

/// Puts stored rows first, first + 1 ... of a picture of size `stored` where they belong in the upright one.
template <class T>
void place_upright(View<const T> rows, int first, Size stored, const Orientation& orientation, View<T> upright) {
  const int channels = rows.channels();
  const auto place = [&](int column, int row) {
    const int along = orientation.from_right ? stored.width - 1 - column : column;
    const int down = orientation.from_bottom ? stored.height - 1 - (first + row) : first + row;
    const int x = orientation.on_its_side ? down : along, y = orientation.on_its_side ? along : down;
    std::copy_n(rows.pixel(column, row), channels, upright.pixel(x, y));
  };
  if (orientation.on_its_side) {  // columns of these rows are runs of the upright rows
    for (int column = 0; column < stored.width; ++column) {
      for (int row = 0; row < rows.height(); ++row) place(column, row);
    }
    return;
  }
  for (int row = 0; row < rows.height(); ++row) {
    for (int column = 0; column < stored.width; ++column) place(column, row);
  }
}

template <class T>
Image<T> upright(Image<T> stored, int exif_orientation) {
  const Orientation orientation(exif_orientation);
  if (orientation.as_is()) return stored;
  const bool on_its_side = orientation.on_its_side, from_right = orientation.from_right;
  const bool from_bottom = orientation.from_bottom;
  const int w = stored.width(), h = stored.height(), channels = stored.channels();
  Image<T> turned(orientation.upright(stored.size()), channels);
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
