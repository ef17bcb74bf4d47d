#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace hdr {

/// The middle one of `values`, the upper of the two where their number is even; 0 of none. Reorders them, in time that
/// is linear in their number.
template <class T>
T median_of(std::vector<T>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace hdr
