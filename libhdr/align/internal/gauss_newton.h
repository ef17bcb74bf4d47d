#pragma once
// One linearisation of the registration problem between two smoothed log pictures.
//   model: b(x + t) = a(x) + gain + contrast (a(x) - mean a), unknowns (t_x, t_y, gain, contrast)
// The gradient is that of `a`, which is never resampled: its noise is then independent of b's, and does not draw t
// towards whole pixels as the gradient of a resampled picture would [Baker04, inverse composition].
#include <vector>

#include "libhdr/align/internal/log_picture.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

using Vec4 = Eigen::Vector4d;

struct PhotometricMatch {
  double gain = 0, contrast = 0;
  double mean = 0;                                         ///< mean of a over the pixels in common
  double scale = std::numeric_limits<double>::infinity();  ///< robust deviation of the residuals, in their own sigmas
};

struct Linearization {
  Mat4 hessian = Mat4::Zero();    ///< J^t W J
  Vec4 score = Vec4::Zero();      ///< J^t W r
  std::vector<Vec4> tile_scores;  ///< the score of each square tile: neighbours' errors are correlated within tiles
  std::size_t pixels = 0;         ///< pixels in common
  double sum_a = 0;               ///< of the unrobust mean of a
  std::vector<float> magnitudes;  ///< |residual| / sigma of a sample of the pixels

  double median_magnitude();
};

/// At the shift t (in pixels of these pictures) and the photometric match.
Linearization linearize(const LogPicture& a, const LogPicture& b, const Vec2& t, const PhotometricMatch& match);

}  // namespace hdr::internal
