// One picture of a mirror ball -> a light probe:  ball_to_probe ball.exr probe.exr [CX CY R]
#include <iostream>
#include <string>

#include "libhdr/hdr.h"

int main(int argc, char** argv) try {
  if (argc != 3 && argc != 6) throw hdr::Error("usage: ball_to_probe BALL.exr PROBE.exr [CX CY R]");
  const hdr::RadianceMap picture = hdr::read_map(argv[1]).map;
  hdr::MirrorBall ball;
  if (argc == 6) {
    ball.disc = {std::stod(argv[3]), std::stod(argv[4]), std::stod(argv[5])};
  } else if (const auto found = hdr::find_ball(picture.rgb)) {
    ball = found->ball;
  } else {
    throw hdr::Error(std::string(argv[1]) + ": no mirror ball found; pass CX CY R");
  }
  const hdr::Size size{1024, 512};
  hdr::write_map(argv[2], hdr::unwrap(picture, ball, hdr::LatLong{size}, size));
  std::cout << "wrote " << argv[2] << '\n';
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
