#pragma once
// Where a picture has suns.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/probe/internal/neighbourhood.h"

namespace hdr::internal {

/// Blocks of 4 x 4 pixels, and whether the brightest of the 12 x 12 pixels around exceeds their geometric mean by more
/// than eight times. There a kernel with negative lobes would leave dark rings, and the tent is used: around a lamp in
/// the picture, not where a smooth one is dark. The largest of a pixel's channels counts; what lies beside a disc or a
/// cube's faces does not.
class Contrast {
 public:
  explicit Contrast(const Neighbourhood& source);

  /// Whether any block that holds one of the pixels first_x <= x <= last_x, first_y <= y <= last_y is harsh.
  bool harsh(int first_x, int first_y, int last_x, int last_y) const;
  bool nowhere_harsh() const { return !any_; }
  /// No sample is below 0, so that no result may be.
  bool nonnegative() const { return nonnegative_; }

 private:
  struct Codes;
  void measure(const Neighbourhood& source, Codes& codes);
  void judge(const Codes& codes);

  int columns_, rows_;
  std::vector<std::uint8_t> harsh_;
  bool any_ = false, nonnegative_ = true;
};

}  // namespace hdr::internal
