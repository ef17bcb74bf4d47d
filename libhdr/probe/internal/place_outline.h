#pragma once
// Where exactly a ball's outline lies, from a guess that is some pixels off.
#include <optional>

#include "libhdr/probe/internal/outline.h"

namespace hdr::internal {

struct PlaceOptions {
  std::optional<double> fov_degrees;  ///< horizontal field of the whole picture: gives the ellipse's shape
  double noise = 1e-3;                ///< standard deviation of a pixel, as a share of its value
  bool plain = false;                 ///< OutlineSearch::plain
};

/// The outline with most evidence within about five pixels of the guess: a circle, unless an ellipse that points at the
/// picture's middle has clearly more, or the field is known.
OutlineFit place_outline(const OutlinePicture& picture, const Ellipse& guess, const PlaceOptions& options);

}  // namespace hdr::internal
