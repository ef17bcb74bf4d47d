// Photographs, merges, lights: something of every module, so that each archive and each library it needs must be found.
// Prints "irradiance R", of a uniform sky of radiance 2: 2 pi.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "capture/camera.h"
#include "libhdr/hdr.h"

int main() {
  hdr::RadianceMap sky;
  sky.rgb = hdr::Image<float>({64, 32}, 3);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) sky.rgb(x, y, c) = 2;
  const auto sh = hdr::project(sky.rgb, hdr::LatLong{{64, 32}}, 2);
  const double irradiance = hdr::irradiance(sh, {0, 1, 0})[0];
  const auto light = hdr::Environment::from_probe(sky, hdr::LatLong{{64, 32}});
  hdr::RenderOptions options;
  options.size = {8, 8};
  options.samples = 4;
  const auto picture = hdr::render(hdr::spheres_on_plane(), light, options);
  hdr::write_map("consumer.exr", picture.picture);
  const auto back = hdr::read_map("consumer.exr").map;
  const auto cameras = hdr::list_cameras();
  std::printf("irradiance %.6f, %d pixels, %d cameras\n", irradiance, back.size().width * back.size().height,
              static_cast<int>(cameras.size()));
  return std::abs(irradiance - 2 * std::numbers::pi) < 1e-5 ? 0 : 1;
}
