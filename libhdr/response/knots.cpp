#include "libhdr/response/internal/knots.h"

#include <algorithm>
#include <cmath>

namespace hdr {
Knots::Knots(int bits, double shoulder) : max_code_(std::ldexp(1.0, bits) - 1), pole_((1 + shoulder) * max_code_) {
  if (bits <= 8) {
    toe_ = 0.05;  // only so that code 0 has a place: dark codes of most cameras follow a power of the light
    middle_ = 1 << (bits - 1);
    for (int code = 0; code <= static_cast<int>(max_code_); ++code) codes_.push_back(code);
  } else {
    // Below the toe the codes of deep photographs are mostly noise.
    constexpr int kKnotsBelowMiddle = 200;
    toe_ = std::ldexp(3.0, bits - 12);
    middle_ = kKnotsBelowMiddle;
    const double middle_code = std::ldexp(1.0, bits - 1);
    const double step = (u_from_code(middle_code) - u_from_code(0)) / kKnotsBelowMiddle;
    for (int k = 0; codes_.empty() || codes_.back() < max_code_; ++k) {
      codes_.push_back(k == 0 ? 0 : k == middle_ ? middle_code : code_from_u(u_from_code(0) + k * step));
    }
    codes_.back() = max_code_;
  }
  for (const double code : codes_) u_.push_back(u_from_code(code));
}

double Knots::u_from_code(double code) const {
  return std::log((code + toe_) / (1 - code / pole_));
}

double Knots::code_from_u(double u) const {
  const double ratio = std::exp(u);
  return (ratio - toe_) / (1 + ratio / pole_);
}

Knots::Place Knots::place(double code) const {
  const auto above = std::upper_bound(codes_.begin(), codes_.end(), code);
  const int knot = std::clamp(static_cast<int>(above - codes_.begin()) - 1, 0, count() - 2);
  const auto k = static_cast<std::size_t>(knot);
  return {knot, (u_from_code(code) - u_[k]) / (u_[k + 1] - u_[k])};
}

}  // namespace hdr
