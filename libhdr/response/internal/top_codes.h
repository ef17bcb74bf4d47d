#pragma once
// The end of the curve, where it matters most: what saturates the shortest shot is the bound of every sun.
#include <Eigen/Core>
#include <array>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/internal/sample_places.h"
#include "libhdr/response/response.h"

namespace hdr {

/// The fit leaves out the codes next to clipping, since their noise is cut off and compression smears them. Their
/// medians suffer less: for light that a shorter shot measured at its middle codes, the median of the codes that a
/// longer shot gave it is the response there, but for what chroma subsampling draws in from clipped neighbours, a few
/// per cent. So above the fit's last code g becomes the mean of what the fit extrapolates and of the medians (run out
/// to the last code along a parabola), weighted by the inverse squares of `deviation`, the fit's doubt, and of those
/// few per cent. 8-bit photographs; others keep their curve (their last codes are narrow). `ln_exposure`: of the shots,
/// as the fit took them; `seen`: top_places() of the bracket.
void measure_top_codes(const Bracket& bracket, const Eigen::VectorXd& ln_exposure, const internal::CodesAtPlaces& seen,
                       const std::array<std::vector<double>, 3>& deviation, Response& response);
internal::CodesAtPlaces top_places(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo);

}  // namespace hdr
