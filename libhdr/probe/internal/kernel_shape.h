#pragma once
// Which part of the source an output pixel's kernel weighs.
#include <algorithm>
#include <cmath>

namespace hdr::internal {

/// The weight of the source pixel with its centre at (i, j), relative to the kernel's middle (x, y), is
///   k((i - x - shear (j - y)) / across) k((j - y) / down):
/// a kernel in rows, each moved along by the shear, which needs no more than one product a pixel, and fits an ellipse
/// that lies at any angle.
struct KernelShape {
  double across = 1, down = 1, shear = 0;
};

/// The larger axis of the ellipse that the Jacobian makes of the output's unit circle.
inline double largest_axis(double x_u, double x_v, double y_u, double y_v) {
  const double a = x_u * x_u + x_v * x_v, b = x_u * y_u + x_v * y_v, c = y_u * y_u + y_v * y_v;
  return std::sqrt(0.5 * (a + c) + std::sqrt(0.25 * (a - c) * (a - c) + b * b));
}

/// From the Jacobian (x_u, x_v; y_u, y_v) of the source position by the output's. The output's unit circle becomes the
/// ellipse with the matrix M = J J^T [Heckbert89]; an axis shorter than a source pixel is made that long, since less
/// than a pixel's kernel would miss them all. Cholesky's factor of M then is the parallelogram.
inline KernelShape kernel_shape(double x_u, double x_v, double y_u, double y_v) {
  double a = x_u * x_u + x_v * x_v, b = x_u * y_u + x_v * y_v, c = y_u * y_u + y_v * y_v;
  const double mean = 0.5 * (a + c), spread = std::sqrt(0.25 * (a - c) * (a - c) + b * b);
  const double largest = mean + spread, least = mean - spread;
  if (largest <= 1) return {};
  if (least < 1) {
    // M = least I + (largest - least) v v^T; its lesser axis becomes 1.
    const double stretch = (largest - 1) / (2 * spread);
    a = 1 + stretch * (a - least);
    b = stretch * b;
    c = 1 + stretch * (c - least);
  }
  return {std::sqrt(std::max(a - b * b / c, 1e-12)), std::sqrt(c), b / c};
}

/// How far the kernel reaches from its middle, in source pixels.
inline double reach_x(const KernelShape& s, double reach) {
  return reach * (s.across + s.down * std::abs(s.shear));
}
inline double reach_y(const KernelShape& s, double reach) {
  return reach * s.down;
}

}  // namespace hdr::internal
