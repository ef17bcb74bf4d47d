#pragma once
// Does a circle or an ellipse bound a mirrored sphere, and where exactly? Read along radii of the picture.
//
// A mirrored sphere has no outline of its own colour: at the rim it shows what is straight behind it. But just inside,
// the reflection sweeps the scene at a rate that is infinite at the rim: the normal's angle goes as sqrt(x), x the
// distance to the rim. Take radiance along a radius for a random walk: outside its clock runs evenly, inside as
// sqrt(x), and where the clock changes is the outline. A step there (a tarnished sphere, a far camera's backdrop) is
// allowed, but a step alone is the edge of something else and counts as no evidence.
#include <array>
#include <memory>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/probe/internal/ball_camera.h"

namespace hdr::internal {

struct OutlineFit {
  Ellipse outline;
  double evidence = 0;     ///< mean over the radii of ln(likelihood with an outline / with anything else), bounded
  double support = 0;      ///< share of the radii, of those in the frame, that speak for the outline
  double in_frame = 0;     ///< share of the outline that the picture shows
  double residual_px = 0;  ///< rms distance of the supporting radii's own best places from the outline
  int radii = 0;           ///< that the picture shows
  std::vector<std::size_t> clocks;  ///< how fast the picture wanders along a radius, of what is tried: the best three
  std::array<double, 8> octants{};  ///< the evidence of all radii, summed by the eighth of the picture they point into
};

struct OutlineSearch {
  int radii = 128;         ///< profiles around the circle
  int half_window_px = 7;  ///< profiles reach this far to both sides, beyond the search
  double range_px = 4;     ///< how far the outline may be from the first guess
  double step_px = 0.125;  ///< the places along a profile that are tried
  std::size_t starts = 1;  ///< places of a coarse grid from which the best one is sought
};

/// A picture in which outlines are sought: one channel each, above 0, of one size. Red and blue tell where the colour
/// changes.
struct OutlinePicture {
  View<const float> luminance, red, blue;
  double noise = 1e-3;  ///< standard deviation of a pixel, as a share of its value
  /// Only the square root of luminance is looked at. Compression leaves colour at half the resolution, which leaks out
  /// of the rim of a full-size picture; and under a higher root the brighter side of the rim spreads over the darker
  /// one. But they see more of an outline while it is still far away.
  bool plain = false;

  Size size() const { return luminance.size(); }
};

/// Finds the outline near a guess with the most evidence.
class OutlineModel {
 public:
  explicit OutlineModel(const OutlineSearch& search);
  /// `elongates`: the larger half-axis is sought, too; else both grow alike. `clocks`: those of a fit close by, where
  /// the picture wanders as it does here; none: all are tried.
  OutlineFit fit(const OutlinePicture& picture, const Ellipse& guess, bool elongates = false,
                 std::vector<std::size_t> clocks = {}) const;

  struct Tables;

 private:
  OutlineSearch search_;
  std::shared_ptr<const Tables> tables_;
};

}  // namespace hdr::internal
