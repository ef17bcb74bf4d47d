#include "libhdr/render/internal/film_filter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

constexpr double kRadius = 1.5;

// Integral of the minimal four-term window from its left end (t = 0) to t, its whole being 1.
double share_below(double t) {
  constexpr double kTerms[] = {0.35875, -0.48829, 0.14128, -0.01168};
  double sum = t;
  for (int k = 1; k < 4; ++k) sum += kTerms[k] / kTerms[0] * std::sin(2 * kPi * k * t) / (2 * kPi * k);
  return sum;
}

// At equal steps of t, from 0 to 1.
using Table = std::array<double, 1025>;
Table make_table() {
  Table table{};
  for (std::size_t k = 0; k < table.size(); ++k)
    table[k] = share_below(static_cast<double>(k) / static_cast<double>(table.size() - 1));
  return table;
}

// The inverse of the share, straight within a step.
double blackman_harris(double u) {
  static const Table table = make_table();
  const auto above = std::upper_bound(table.begin() + 1, table.end() - 1, u);
  const double low = *(above - 1), high = *above;
  const double within = high > low ? std::clamp((u - low) / (high - low), 0.0, 1.0) : 0.5;
  const double t = (static_cast<double>(above - 1 - table.begin()) + within) / static_cast<double>(table.size() - 1);
  return (2 * t - 1) * kRadius;
}

}  // namespace

Vec2 filtered_place(FilmFilter filter, const Vec2& u) {
  if (filter == FilmFilter::kBox) return u;
  return {0.5 + blackman_harris(u.x()), 0.5 + blackman_harris(u.y())};
}

}  // namespace hdr
