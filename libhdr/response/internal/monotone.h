#pragma once
#include <vector>

namespace hdr {

/// The nearest nondecreasing sequence, by least squares (pool adjacent violators).
void make_nondecreasing(std::vector<double>& values);

}  // namespace hdr
