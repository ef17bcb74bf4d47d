#include "libhdr/filter/internal/quantile.h"

#include <algorithm>
#include <vector>

#include "libhdr/filter/internal/display.h"

namespace hdr::internal {

double luminance_quantile(View<const float> rgb, double share) {
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(rgb.width()) * static_cast<std::size_t>(rgb.height()));
  for (int y = 0; y < rgb.height(); ++y)
    for (int x = 0; x < rgb.width(); ++x) values.push_back(static_cast<float>(pixel_luminance(rgb.pixel(x, y))));
  if (values.empty()) return 0;
  const auto rank = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), rank, values.end());
  return *rank;
}

}  // namespace hdr::internal
