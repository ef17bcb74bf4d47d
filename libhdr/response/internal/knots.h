#pragma once
// The codes at which the fit knows g; in between g is linear in u.
#include <cmath>
#include <vector>

namespace hdr {

/// Smoothness is judged against u = ln(code + toe) - ln(1 - code / ((1 + shoulder) max_code)). With shoulder infinite a
/// power law is nearly straight in u; with a finite one so is a film's shoulder, which otherwise bends most where the
/// data end. 8 bits: a knot at every code. Deeper: knots uniform in u.
class Knots {
 public:
  explicit Knots(int bits, double shoulder = INFINITY);

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
  double u_from_code(double code) const;
  double code_from_u(double u) const;

  double max_code_, pole_, toe_ = 0;
  int middle_ = 0;
  std::vector<double> codes_, u_;
};

}  // namespace hdr
