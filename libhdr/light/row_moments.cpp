#include "libhdr/light/internal/row_moments.h"

#include <cmath>

#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

constexpr std::ptrdiff_t kPadding = 8;  // doubles of the widest vector

}  // namespace

AzimuthTable::AzimuthTable(int width, int degree)
    : width_(width),
      degree_(degree),
      cell_(2 * kPi / width),
      stride_(((width / 4 + 1) / 2 + kPadding - 1) / kPadding * kPadding),
      eighth_(static_cast<std::size_t>(2 * (degree + 1) * stride_), 0.0) {
  HDR_ASSERT(width > 0 && degree >= 0);
  const int quarter = width / 4;
  std::vector<double> chords;
  for (int m = 0; m <= degree; ++m) chords.push_back(chord(m));
  for (int x = 0; x < (quarter + 1) / 2; ++x) {
    const double delta = cell_ * (0.5 * quarter - (x + 0.5)), share = 2 * x + 1 == quarter ? 0.5 : 1;
    const Vec2 one(std::cos(delta), std::sin(delta));
    Vec2 wave(share, 0);  // cos and sin of m delta
    for (int m = 0; m <= degree; ++m) {
      double* cosine = eighth_.data() + 2 * m * stride_ + x;
      cosine[0] = chords[static_cast<std::size_t>(m)] * wave.x();
      cosine[stride_] = chords[static_cast<std::size_t>(m)] * wave.y();
      wave = {wave.x() * one.x() - wave.y() * one.y(), wave.x() * one.y() + wave.y() * one.x()};
    }
  }
}

double AzimuthTable::middle(int x) const {
  return 2 * kPi * (0.5 - (x + 0.5) / width_);
}

// The integral of cos(m phi) over a cell is cos at its middle times this.
double AzimuthTable::chord(int m) const {
  if (m == 0) return cell_;
  return 2 * std::sin(0.5 * m * cell_) / m;
}

Eigen::MatrixXd AzimuthTable::whole() const {
  Eigen::MatrixXd table(width_, count());
  for (int x = 0; x < width_; ++x) {
    table(x, 0) = cell_;
    for (int m = 1; m <= degree_; ++m) {
      table(x, 2 * m - 1) = chord(m) * std::cos(m * middle(x));
      table(x, 2 * m) = chord(m) * std::sin(m * middle(x));
    }
  }
  return table;
}

namespace reference {

void row_moments(View<const float> rows, const AzimuthTable& table, double* moments) {
  const Eigen::MatrixXd azimuth = table.whole();
  for (int y = 0; y < rows.height(); ++y) {
    const Eigen::Map<const Eigen::Matrix3Xf> row(rows.row(y), 3, rows.width());
    Eigen::Map<Eigen::Matrix3Xd>(moments + static_cast<std::ptrdiff_t>(y) * 3 * table.count(), 3, table.count()) =
        row.cast<double>() * azimuth;
  }
}

}  // namespace reference
}  // namespace hdr
