#pragma once
// One linearisation of the registration problem between two smoothed log pictures.
//   model: b(W(x)) = a(x + e(x)) + m(a(x)), unknowns the motion e that W still lacks and the photometric match m
// m is piecewise linear in ln radiance: 0 for an exact response and exposure, a constant for a wrong exposure, a curve
// for a wrong response. Found together with e, it cannot pass for motion.
// The gradient is that of `a`, which is never resampled: its noise is then independent of b's, and does not draw the
// motion towards whole pixels as the gradient of a resampled picture would [Baker04, inverse composition]: the better
// motion is W (I + e)^-1.
// What is kept are sums over square tiles, each with a shift of its own: every motion model is solved from the same
// sums, and tiles are the independent observations that tell how much freedom the pictures support.
#include <array>
#include <limits>
#include <vector>

#include "libhdr/align/internal/log_picture.h"
#include "libhdr/align/internal/motion.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

inline constexpr int kKnots = 8;
using KnotVector = Eigen::Matrix<double, kKnots, 1>;

/// m(a), linear between knots at first, first + step, ...
struct PhotometricMatch {
  double first = 0, step = 1;
  KnotVector value = KnotVector::Zero();
  double scale = std::numeric_limits<double>::infinity();  ///< robust deviation of the residuals, in their own sigmas
};

/// m = 0, with knots spread over the usable pixels of `a`.
PhotometricMatch unmatched(const LogPicture& a);

/// J^t W J and J^t W r of one tile: a shift (photograph pixels) and the knots. A pixel touches two neighbouring knots
/// only, so that part is a band.
struct TileSums {
  Vec2 middle = Vec2::Zero();  ///< of the tile in the photograph, pixels
  double xx = 0, xy = 0, yy = 0;
  std::array<double, kKnots> x_knot{}, y_knot{}, knot{}, next_knot{};
  Vec2 shift_score = Vec2::Zero();
  KnotVector knot_score = KnotVector::Zero();
  double noise = 0;  ///< what noise alone adds to xx and to yy
  int pixels = 0;
};

/// Variance, along each axis, of the gradient of binomially smoothed white noise, as a share of the noise's own:
/// 0.5 x (6/16)^2 x (1 - 1/6).
inline constexpr double kGradientNoise = 0.0586;

struct Linearization {
  std::vector<TileSums> tiles;    ///< those with pixels in common
  std::size_t pixels = 0;         ///< in common
  std::vector<float> magnitudes;  ///< |residual| / sigma of a sample of the pixels

  double median_magnitude();
};

/// At the motion `b_from_a` (of photograph pixels) and the photometric match.
Linearization linearize(const LogPicture& a, const LogPicture& b, const Mat3& b_from_a, const PhotometricMatch& match);

/// The side of the tiles of a picture of this size, in its own pixels.
int tile_side(Size size);

}  // namespace hdr::internal
