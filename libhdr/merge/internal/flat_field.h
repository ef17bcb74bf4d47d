#pragma once
#include <array>

#include "libhdr/core/image.h"

namespace hdr::internal {

/// What a flat field multiplies a pixel with: its maximum over its value, a channel at a time.
class FlatField {
 public:
  /// `flat` may be empty: all gains are 1. Throws Error for another size and for values that are not positive numbers.
  FlatField(View<const float> flat, Size size);

  bool empty() const { return flat_.empty(); }
  std::array<float, 3> gain(int x, int y) const;

 private:
  View<const float> flat_;
  std::array<float, 3> maximum_{};
};

}  // namespace hdr::internal
