#pragma once
#include <utility>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/projection.h"

namespace hdr::bench {

/// A band-limited world, known everywhere: ten plane waves of up to `most_waves` radians a radian (a quarter of the
/// Nyquist frequency of a lat-long that is eight times as wide).
class World {
 public:
  explicit World(double most_waves);
  void at(const Vec3& d, float* rgb) const;

 private:
  std::vector<std::pair<Vec3, double>> waves_;
};

/// Sampled at pixel centres; 0 where the projection shows nothing.
Image<float> picture_of(const World& world, const Projection& projection, Size size);

}  // namespace hdr::bench
