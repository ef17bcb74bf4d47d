#pragma once
// The sphere cut into strata of a probe's light, from each of which directions are drawn by luminance: an estimate that
// takes one from every stratum is unbiased, and has no noise from how bright the strata are.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

class LightStrata {
 public:
  /// Structured importance sampling [Agarwal03], by make_lights(). `latlong` must outlive the strata.
  static LightStrata structured(View<const float> latlong, int count);

  /// Cells of an even grid over the map, twice as many across as down, `count` or a few less; every pixel is one of its
  /// own when there are as many.
  static LightStrata grid(View<const float> latlong, int count);

  /// Strata that have light; fewer than were asked for where the map has fewer pixels or black regions.
  int count() const { return static_cast<int>(ends_.size()); }

  struct Sample {
    Vec3f dir;
    Rgbf light;  ///< luminance of the stratum's irradiance in the colour of this direction
  };
  /// u in [0,1)^2.
  Sample sample(int stratum, const Vec2& u) const;

 private:
  struct Pixel {
    int x, y;
  };

  explicit LightStrata(View<const float> latlong);
  Pixel pixel_of(std::int32_t cell, double& u) const;
  void append(std::int32_t cell);
  void end_stratum();

  View<const float> map_;
  int block_;  ///< a cell is this many pixels wide and high; the last ones may be cut
  Size cells_;
  std::vector<double> luminances_;     ///< of each cell: the integral
  std::vector<std::int32_t> members_;  ///< cells, stratum after stratum
  std::vector<double> sums_;       ///< of luminance, of the members up to and with each, from its stratum's beginning
  std::vector<std::size_t> ends_;  ///< of the strata, in members_
};

}  // namespace hdr
