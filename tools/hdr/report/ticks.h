#pragma once
// Where an axis has its marks, and what stands beside them.
#include <string>
#include <vector>

namespace hdr::report {

struct Tick {
  double value = 0;
  std::string label;  ///< empty: a mark without a number
};

/// Multiples of 1, 2 or 5 times a power of ten, about `count` of them, within [low, high].
std::vector<Tick> linear_ticks(double low, double high, int count);

/// Powers of ten, with 2 and 5 between them where there are few, and unlabelled marks for the rest; 0 < low < high.
/// Over many decades every second, third ... power.
std::vector<Tick> log_ticks(double low, double high, int count);

}  // namespace hdr::report
