#include "libhdr/response/internal/fill_gaps.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"

namespace hdr {

std::vector<double> fill_gaps(std::vector<double> exposures) {
  std::vector<std::size_t> known;
  for (std::size_t k = 0; k < exposures.size(); ++k) {
    if (exposures[k] > 0) known.push_back(k);
  }
  HDR_ASSERT(!known.empty());
  const std::size_t first = known.front(), last = known.back();
  for (std::size_t k = 0; k < first; ++k) {
    exposures[k] = exposures[first] * static_cast<double>(k) / static_cast<double>(first);
  }
  for (std::size_t n = 0; n + 1 < known.size(); ++n) {
    const double low = exposures[known[n]], high = exposures[known[n + 1]];
    for (std::size_t k = known[n] + 1; k < known[n + 1]; ++k) {
      const double t = static_cast<double>(k - known[n]) / static_cast<double>(known[n + 1] - known[n]);
      exposures[k] = (1 - t) * low + t * high;
    }
  }
  const std::size_t stretch = std::min(last - first, exposures.size() / 16);
  const double rise =
      stretch > 0 ? std::log(exposures[last] / exposures[last - stretch]) / static_cast<double>(stretch) : 0;
  for (std::size_t k = last + 1; k < exposures.size(); ++k) {
    exposures[k] = exposures[last] * std::exp(std::max(0.0, rise) * static_cast<double>(k - last));
  }
  return exposures;
}

}  // namespace hdr
