#pragma once
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"

namespace hdr::internal {

/// Histogram of positive luminance: rows are added as they come, and the parts of several threads joined.
class LuminanceHistogram {
 public:
  LuminanceHistogram();
  void add(View<const float> rgb);
  void join(const LuminanceHistogram& part);
  /// log2 of the 99.9 % over the 0.1 % quantile of positive luminance, to 1/100 stop; 0 when nothing is positive.
  double stops() const;

 private:
  std::vector<std::int64_t> bins_;
};

}  // namespace hdr::internal
