#pragma once
// Sums along the rows of a lat-long of its pixels times cos and sin of multiples of the azimuth: the separable half of
// a projection. Sums and products are in double.
#include <numbers>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// Integrals over each column of 1, cos phi, sin phi, cos 2phi, ... for maps of one width. Column x holds azimuths
/// 2 pi (1/2 - u), u from x/W to (x+1)/W.
class AzimuthTable {
 public:
  AzimuthTable(int width, int degree);

  int width() const { return width_; }
  int degree() const { return degree_; }
  int count() const { return 2 * degree_ + 1; }  ///< moments of a row

  /// width x count: 1, cos phi, sin phi, cos 2phi, ...
  Eigen::MatrixXd whole() const;

  /// cos and sin of m delta, delta the angle from the middle of the first quarter of the columns (azimuth 3 pi / 4),
  /// over the first half of that quarter, filled up with zeros to stride(): all other columns are the same but for
  /// signs and turns. Of a column in the very middle, half. m = 0: the cell, and 0.
  const double* cosines(int m) const { return eighth_.data() + 2 * m * stride_; }
  const double* sines(int m) const { return cosines(m) + stride_; }
  std::ptrdiff_t stride() const { return stride_; }
  double cell() const { return cell_; }

  /// cos and sin of k pi / 4, k >= 0.
  static Vec2 turn(int k) {
    constexpr double kHalf = std::numbers::sqrt2 / 2;
    constexpr double kCosines[] = {1, kHalf, 0, -kHalf, -1, -kHalf, 0, kHalf};
    return {kCosines[k % 8], kCosines[(k + 6) % 8]};
  }

 private:
  double middle(int x) const;
  double chord(int m) const;

  int width_, degree_;
  double cell_;
  std::ptrdiff_t stride_;
  std::vector<double> eighth_;
};

/// moments[(row * count + k) * 3 + channel]: the whole map's width, any number of rows.
void row_moments(View<const float> rows, const AzimuthTable& table, double* moments);

namespace reference {
void row_moments(View<const float> rows, const AzimuthTable& table, double* moments);
}

}  // namespace hdr
