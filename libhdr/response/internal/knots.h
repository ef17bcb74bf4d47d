#pragma once
// The codes at which the fit knows g; in between g is linear in u.
#include <vector>

namespace hdr {

/// 8 bits: every code. Deeper: codes uniform in u = ln(code + c), in which a power law is nearly straight, so that
/// smoothness means the same at all depths.
class Knots {
 public:
  explicit Knots(int bits);

  int count() const { return static_cast<int>(codes_.size()); }
  int middle() const { return middle_; }  ///< the knot at code 2^(bits-1)
  double max_code() const { return max_code_; }
  double code(int knot) const { return codes_[static_cast<std::size_t>(knot)]; }
  double u(int knot) const { return u_[static_cast<std::size_t>(knot)]; }

  /// g(code) = (1 - t) g[knot] + t g[knot + 1]
  struct Place {
    int knot;
    double t;
  };
  Place place(double code) const;

 private:
  double offset_, max_code_;
  int middle_ = 0;
  std::vector<double> codes_, u_;
};

}  // namespace hdr
