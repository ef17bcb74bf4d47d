#pragma once
// A log picture seen through a motion, row by row.
#include <array>
#include <vector>

#include "libhdr/align/internal/log_picture.h"
#include "libhdr/align/internal/motion.h"

namespace hdr::internal {

/// b(W(x)) by Catmull-Rom's cubic: through the samples, and third order.
class WarpedRows {
 public:
  /// `b_from_a` is in pixels of these pictures.
  WarpedRows(const LogPicture& b, const Mat3& b_from_a);

  /// ln and variance at the places that pixels first ... last - 1 of row y of `a` show; variance is kUnusable where the
  /// sixteen neighbours do not lie in b.
  void resample(int y, int first, int last, float* ln, float* variance) const;

 private:
  void resample_shifted(int y, int first, int last, float* ln, float* variance) const;

  const LogPicture& b_;
  Mat3 motion_;
  bool affine_, whole_rows_;  ///< whole_rows_: one shift for all pixels, so the sixteen taps are constants
};

}  // namespace hdr::internal
