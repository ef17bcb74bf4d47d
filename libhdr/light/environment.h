#pragma once
// A probe as a light: radiance(dir), sample(u) -> dir, pdf(dir), and invert(dir) -> u, the inverse of sample.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/radiance.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/projection.h"

namespace hdr {

/// Importance sampling of a piecewise-constant lat-long by luminance times solid angle: row marginal, then column
/// conditional, sums in double. An all-black map samples the sphere uniformly. No pixel with energy is unreachable.
class Environment {
 public:
  /// A lat-long with three channels, finite and non-negative (read_map has seen to it).
  explicit Environment(Image<float> latlong);

  /// From any projection, resampled to a lat-long of `width` (0: as fine as the source's middle).
  static Environment from_probe(const RadianceMap& probe, const Projection& projection, int width = 0);

  struct Sample {
    Vec3f dir;
    Rgbf radiance;
    float pdf;  ///< per steradian
  };

  Rgbf radiance(const Vec3f& dir) const;
  Sample sample(const Vec2& u) const;    ///< u in [0,1)^2
  float pdf(const Vec3f& dir) const;
  Vec2 invert(const Vec3f& dir) const;   ///< u with sample(u).dir = dir

  View<const float> latlong() const { return map_; }
  bool black() const { return total_ == 0; }
  Rgb total_power() const { return power_; }  ///< integral of L over the sphere, per channel

 private:
  Image<float> map_;
  std::vector<double> marginal_;     ///< height + 1, from 0 to 1
  std::vector<double> conditional_;  ///< height rows of width + 1, each from 0 to 1
  double total_ = 0;                 ///< integral of luminance
  Rgb power_ = Rgb::Zero();
};

}  // namespace hdr
