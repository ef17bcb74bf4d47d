#include "libhdr/merge/internal/flat_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"

namespace hdr::internal {

FlatField::FlatField(View<const float> flat, Size size) : flat_(flat) {
  if (flat.empty()) return;
  if (flat.size() != size || flat.channels() != 3) {
    throw Error(
        fmt::format("flat field: is {}x{} with {} channels, but the shots are {}x{} with 3; photograph it with "
                    "the same camera mode",
                    flat.width(), flat.height(), flat.channels(), size.width, size.height));
  }
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = flat.pixel(x, y)[c];
        if (!(value > 0 && std::isfinite(value))) {
          throw Error(fmt::format("flat field: pixel ({}, {}) is {} in channel {}, which divides nothing; mend it", x,
                                  y, value, c));
        }
        maximum_[c] = std::max(maximum_[c], value);
      }
    }
  }
}

std::array<float, 3> FlatField::gain(int x, int y) const {
  if (empty()) return {1, 1, 1};
  const float* p = flat_.pixel(x, y);
  return {maximum_[0] / p[0], maximum_[1] / p[1], maximum_[2] / p[2]};
}

}  // namespace hdr::internal
