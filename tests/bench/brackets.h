#pragma once
// Brackets of known truth, photographed by expose() from a scene that we invent.
#include <cstdint>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/response.h"

namespace hdr::bench {

/// test_scene's ramp, waves and boxes, interpolated in ln from an eighth of the size, with fractal texture as surfaces
/// have it, and a few lamps that no shot of a usual bracket holds: about 16 stops, median near 1.
Image<float> textured_scene(Size size, std::uint64_t seed);

/// A radiance map stretched to `size` in ln, with the same texture: what real light looks like through a large sensor.
Image<float> textured_map(View<const float> map, Size size, std::uint64_t seed);

/// level = radiance * k * seconds of full well.
struct Truth {
  Image<float> radiance;
  Response response;
  double k = 0;
  std::vector<double> seconds;
};

struct BracketPlan {
  Size size{1200, 800};
  std::vector<double> evs;  ///< stops from the middle shot, in which the median fills 18 % of full well
  Response response;
  std::string format = "jpg";  ///< quality 95, 4:2:0; png, tif
  std::uint64_t seed = 1;
  Path map;                              ///< the scene is textured_map() of this, not textured_scene()
  std::vector<Mat3> scene_from_photo{};  ///< of each shot, as shake() takes it; empty: none has moved
};

/// `count` shots, `step` stops apart, the middle one at 0.
std::vector<double> uniform_evs(int count, double step);

/// Photographs the scene into `folder`, shot_NN.FORMAT with EXIF. 30000 electrons of full well, 5 of read noise.
Truth photograph(const BracketPlan& plan, const Path& folder);

}  // namespace hdr::bench
