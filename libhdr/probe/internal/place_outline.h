#pragma once
// Where exactly a ball's outline lies, from a guess that is some pixels off.
#include <optional>

#include "libhdr/probe/internal/outline.h"

namespace hdr::internal {

class OutlinePlacer {
 public:
  /// `fov_degrees`: horizontal field of the whole picture: gives the ellipse's shape.
  explicit OutlinePlacer(std::optional<double> fov_degrees);
  /// The outline with most evidence within about five pixels of the guess: a circle, unless an ellipse that points at
  /// the picture's middle has clearly more, or the field is known.
  OutlineFit operator()(const OutlinePicture& picture, const Ellipse& guess) const;

 private:
  std::optional<double> fov_degrees_;
  OutlineModel start_, wide_, close_;  ///< few radii; many, from afar; many, close by
};

}  // namespace hdr::internal
