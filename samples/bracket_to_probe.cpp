// Bracketed photographs of a mirror ball -> a light probe:  bracket_to_probe probe.exr shots/*.jpg
#include <iostream>

#include "libhdr/hdr.h"

int main(int argc, char** argv) try {
  if (argc < 4) throw hdr::Error("usage: bracket_to_probe PROBE.exr SHOT SHOT...");
  const std::vector<hdr::Path> files(argv + 2, argv + argc);
  const hdr::Bracket shots = hdr::read_bracket(files);
  const hdr::Alignment alignment = hdr::align(shots, hdr::provisional_response(shots));
  const hdr::Calibration calibration = hdr::calibrate_debevec_malik(shots, alignment.ref_from_photo());
  const hdr::Merged merged = hdr::merge(shots, alignment, calibration.response);
  const auto ball = hdr::find_ball(merged.map.rgb);
  if (!ball) throw hdr::Error("no mirror ball found in the shots");
  const hdr::Size size{1024, 512};
  hdr::write_map(argv[1], hdr::unwrap(merged.map, ball->ball, hdr::LatLong{size}, size));
  std::cout << "ball at " << ball->ball.disc.cx << ", " << ball->ball.disc.cy << ", radius " << ball->ball.disc.r << " px; "
            << "response fitted to " << calibration.rms_log_error << " (ln)\n";
} catch (const hdr::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
