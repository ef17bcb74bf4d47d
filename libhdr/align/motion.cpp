#include "libhdr/align/internal/motion.h"

#include <algorithm>
#include <cmath>

namespace hdr::internal {
namespace {

constexpr int kGrid = 5;  // points a side that stand for the picture

/// Calls visit(p) for points that stand for the picture, corners included.
template <class Visit>
void for_grid(Size size, const Visit& visit) {
  for (int j = 0; j < kGrid; ++j) {
    for (int i = 0; i < kGrid; ++i) {
      visit(Vec2((size.width - 1.0) * i / (kGrid - 1), (size.height - 1.0) * j / (kGrid - 1)));
    }
  }
}

}  // namespace

MotionFrame::MotionFrame(Size picture_size)
    : size(picture_size),
      middle(0.5 * (picture_size.width - 1), 0.5 * (picture_size.height - 1)),
      radius(std::max(1.0, middle.norm())) {}

MotionBasis MotionFrame::basis(const Vec2& p) const {
  const Vec2 n = (p - middle) / radius;
  const double u = n.x(), v = n.y();
  MotionBasis b;
  b << 1, 0, -v, u, u, v, u * u, u * v,  //
      0, 1, u, v, -v, u, u * v, v * v;
  return b;
}

Mat3 MotionFrame::motion(const MotionVector& small) const {
  if (small.tail<kMotionUnknowns - 2>().isZero(0)) return shift_by(small.head<2>());
  const MotionVector q = small / radius;
  Mat3 stretch = Mat3::Identity();
  stretch(0, 0) += q[3] + q[4];
  stretch(1, 1) += q[3] - q[4];
  stretch(0, 1) = stretch(1, 0) = q[5];
  stretch(2, 0) = -q[6];
  stretch(2, 1) = -q[7];
  Mat3 turn = Mat3::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(q[2]).toRotationMatrix();
  Mat3 to_pixels = Mat3::Identity();
  to_pixels.topLeftCorner<2, 2>() *= radius;
  to_pixels.topRightCorner<2, 1>() = middle;
  const Mat3 normalised = shift_by(q.head<2>()) * turn * stretch;
  const Mat3 m = to_pixels * normalised * to_pixels.inverse();
  return m / m(2, 2);
}

MotionVector MotionFrame::vector(const Mat3& motion) const {
  Mat3 to_pixels = Mat3::Identity();
  to_pixels.topLeftCorner<2, 2>() *= radius;
  to_pixels.topRightCorner<2, 1>() = middle;
  Mat3 m = to_pixels.inverse() * motion * to_pixels;
  m /= m(2, 2);
  MotionVector q;
  q.head<2>() = (moved(motion, middle) - middle) / radius;  // no motion gives zeros, exactly
  m = shift_by(-q.head<2>()) * m;
  q[2] = std::atan2(m(1, 0) - m(0, 1), m(0, 0) + m(1, 1));
  m.topRows<2>() = Eigen::Rotation2Dd(-q[2]).toRotationMatrix() * m.topRows<2>();
  q[3] = 0.5 * (m(0, 0) + m(1, 1)) - 1;
  q[4] = 0.5 * (m(0, 0) - m(1, 1));
  q[5] = 0.5 * (m(0, 1) + m(1, 0));
  q[6] = -m(2, 0);
  q[7] = -m(2, 1);
  return q * radius;
}

double MotionFrame::rms(const MotionMatrix& covariance) const {
  double sum = 0;
  for_grid(size, [&](const Vec2& p) {
    const MotionBasis b = basis(p);
    sum += (b * covariance * b.transpose()).trace();
  });
  return std::sqrt(std::max(0.0, sum) / (kGrid * kGrid));
}

double MotionFrame::rms_between(const Mat3& one, const Mat3& other) const {
  double sum = 0;
  for_grid(size, [&](const Vec2& p) { sum += (moved(one, p) - moved(other, p)).squaredNorm(); });
  return std::sqrt(sum / (kGrid * kGrid));
}

double MotionFrame::farthest_between(const Mat3& one, const Mat3& other) const {
  double farthest = 0;
  for_grid(size, [&](const Vec2& p) { farthest = std::max(farthest, (moved(one, p) - moved(other, p)).norm()); });
  return farthest;
}

Mat3 shift_by(const Vec2& shift) {
  Mat3 m = Mat3::Identity();
  m.topRightCorner<2, 1>() = shift;
  return m;
}

Mat3 motion_of_cells(const Mat3& motion, int cell) {
  // Cell x covers the pixels cell x ... cell x + cell - 1, with their middle at cell x + (cell - 1) / 2.
  Mat3 pixel_from_cell = Mat3::Identity();
  pixel_from_cell.topLeftCorner<2, 2>() *= cell;
  pixel_from_cell.topRightCorner<2, 1>().setConstant(0.5 * (cell - 1));
  return pixel_from_cell.inverse() * motion * pixel_from_cell;
}

}  // namespace hdr::internal
