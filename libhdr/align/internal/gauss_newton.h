#pragma once
// One linearisation of the registration problem between two smoothed log pictures.
//   model: b(x + t) = a(x) + m(a(x)), unknowns the shift t and the photometric match m
// m is piecewise linear in ln radiance: 0 for an exact response and exposure, a constant for a wrong exposure, a curve
// for a wrong response. Found together with t, it cannot pass for motion.
// The gradient is that of `a`, which is never resampled: its noise is then independent of b's, and does not draw t
// towards whole pixels as the gradient of a resampled picture would [Baker04, inverse composition].
#include <array>
#include <vector>

#include "libhdr/align/internal/log_picture.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

inline constexpr int kKnots = 8;
inline constexpr int kUnknowns = 2 + kKnots;  ///< t_x, t_y, m at the knots
using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Hessian = Eigen::Matrix<double, kUnknowns, kUnknowns>;

/// m(a), linear between knots at first, first + step, ...
struct PhotometricMatch {
  double first = 0, step = 1;
  Eigen::Matrix<double, kKnots, 1> value = Eigen::Matrix<double, kKnots, 1>::Zero();
  double scale = std::numeric_limits<double>::infinity();  ///< robust deviation of the residuals, in their own sigmas
};

/// m = 0, with knots spread over the usable pixels of `a`.
PhotometricMatch unmatched(const LogPicture& a);

struct Linearization {
  Hessian hessian = Hessian::Zero();  ///< J^t W J
  Unknowns score = Unknowns::Zero();  ///< J^t W r
  std::vector<Unknowns> tile_scores;  ///< the score of each square tile: neighbours' errors are correlated within tiles
  std::size_t pixels = 0;             ///< pixels in common
  std::vector<float> magnitudes;      ///< |residual| / sigma of a sample of the pixels

  double median_magnitude();
};

/// At the shift t (in pixels of these pictures) and the photometric match.
Linearization linearize(const LogPicture& a, const LogPicture& b, const Vec2& t, const PhotometricMatch& match);

}  // namespace hdr::internal
