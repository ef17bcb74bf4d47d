// A light probe -> a picture lit by it, and the irradiance of a floor:  probe_to_render probe.exr render.png
#include <iostream>

#include "libhdr/hdr.h"

int main(int argc, char** argv) try {
  if (argc != 3) throw hdr::Error("usage: probe_to_render PROBE.exr RENDER.png");
  const hdr::RadianceMap probe = hdr::read_map(argv[1]).map;
  const hdr::Projection projection = hdr::projection_of_probe("", probe.projection, probe.size(), argv[1]);
  const hdr::Sh sh = hdr::project(probe.rgb, projection, 2);  // degree 2: nine coefficients
  std::cout << "irradiance, facing up: " << hdr::irradiance(sh, {0, 1, 0}).transpose() << '\n';

  const hdr::Environment light = hdr::Environment::from_probe(probe, projection);
  const hdr::Rendering picture = hdr::render(hdr::spheres_on_plane(), light, {.size = {320, 240}, .samples = 32});
  std::cout << "estimated error: " << picture.estimated_error << '\n';
  const hdr::RadianceMap& map = picture.picture;
  hdr::write_picture(argv[2], hdr::tonemap(map.rgb, hdr::metered_stops(map.rgb)));
} catch (const hdr::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
