#include "libhdr/response/internal/knots.h"

#include <algorithm>
#include <cmath>

namespace hdr {

Knots::Knots(int bits) : max_code_(std::ldexp(1.0, bits) - 1) {
  if (bits <= 8) {
    offset_ = 0.5;
    middle_ = 1 << (bits - 1);
    for (int code = 0; code <= static_cast<int>(max_code_); ++code) codes_.push_back(code);
  } else {
    // Below c the codes of deep photographs are mostly noise, and knots stand about c/20 codes apart.
    constexpr int kKnotsBelowMiddle = 200;
    offset_ = std::ldexp(3.0, bits - 12);
    middle_ = kKnotsBelowMiddle;
    const double middle_code = std::ldexp(1.0, bits - 1);
    const double step = std::log((middle_code + offset_) / offset_) / kKnotsBelowMiddle;
    for (int k = 0; codes_.empty() || codes_.back() < max_code_; ++k) {
      codes_.push_back(k == middle_ ? middle_code : offset_ * std::expm1(k * step));
    }
  }
  for (const double code : codes_) u_.push_back(std::log(code + offset_));
}

Knots::Place Knots::place(double code) const {
  const auto above = std::upper_bound(codes_.begin(), codes_.end(), code);
  const int knot = std::clamp(static_cast<int>(above - codes_.begin()) - 1, 0, count() - 2);
  const auto k = static_cast<std::size_t>(knot);
  return {knot, (std::log(code + offset_) - u_[k]) / (u_[k + 1] - u_[k])};
}

}  // namespace hdr
