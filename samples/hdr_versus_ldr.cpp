// Why light must not be cut off at white: the same operations on a light probe (above) and on an 8-bit picture of it
// (below), shown at one exposure:  hdr_versus_ldr PROBE.exr FOLDER
#include <filesystem>
#include <functional>
#include <iostream>

#include "libhdr/hdr.h"

namespace {

using Map = hdr::Image<float>;

/// What an 8-bit photograph keeps of it: codes up to 255, made linear again.
Map as_ldr(const Map& map, double stops) {
  const hdr::Image<std::uint8_t> codes = hdr::tonemap(map, stops, {}, hdr::ToneOperator::kClip);
  Map ldr(map.size(), 3);
  for (int y = 0; y < map.height(); ++y) {
    for (std::size_t k = 0; k < map.row_samples(); ++k) {
      ldr.row(y)[k] = static_cast<float>(hdr::linear_from_srgb(codes.row(y)[k] / 255.0) * std::exp2(-stops));
    }
  }
  return ldr;
}

/// The light that a matt white surface facing each direction sends on, from nine coefficients.
Map irradiance_map(const Map& map) {
  const hdr::Sh sh = hdr::project(map, hdr::LatLong{map.size()}, 2);
  Map out(map.size(), 3);
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      const hdr::Vec3 n = hdr::dir_from_latlong((x + 0.5) / map.width(), (y + 0.5) / map.height());
      const hdr::Rgb light = hdr::irradiance(sh, n) / hdr::kPi;
      for (int c = 0; c < 3; ++c) out(x, y, c) = static_cast<float>(light[c]);
    }
  }
  return out;
}

/// HDR before and after above, LDR before and after below, a column at one exposure; white lines between.
hdr::Image<std::uint8_t> side_by_side(const Map (&maps)[4], double before, double after) {
  constexpr int kGap = 6;
  const int w = maps[0].width(), h = maps[0].height();
  hdr::Image<std::uint8_t> sheet(2 * w + kGap, 2 * h + kGap, 3);
  for (int y = 0; y < sheet.height(); ++y) std::fill_n(sheet.row(y), sheet.row_samples(), std::uint8_t{255});
  for (int k = 0; k < 4; ++k) {
    const auto codes = hdr::tonemap(maps[k], k % 2 ? after : before, {}, hdr::ToneOperator::kClip);
    for (int y = 0; y < h; ++y) {
      std::copy_n(codes.row(y), codes.row_samples(), sheet.pixel((k % 2) * (w + kGap), (k / 2) * (h + kGap) + y));
    }
  }
  return sheet;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) throw hdr::Error("usage: hdr_versus_ldr PROBE.exr FOLDER");
  const hdr::RadianceMap probe = hdr::read_map(argv[1]).map;
  const bool square = probe.projection.empty() && probe.rgb.width() == probe.rgb.height();  // Debevec's are angular
  const hdr::Projection from =
      hdr::projection_of_probe(square ? "angular" : "", probe.projection, probe.size(), argv[1]);
  const hdr::Size size{720, 360};
  const Map hdr_map = hdr::unwrap(probe, from, hdr::LatLong{size}, size).rgb.clone();
  const double stops = hdr::metered_stops(hdr_map) + 1;
  const Map ldr_map = as_ldr(hdr_map, stops);

  const auto sphere = hdr::Surface::kLatLong;
  const std::pair<const char*, std::function<Map(const Map&)>> operations[] = {
      {"gaussian", [&](const Map& map) { return hdr::gaussian_blur(map, 9, sphere); }},
      {"motion", [&](const Map& map) { return hdr::motion_blur(map, 90, 0, sphere); }},
      {"exposure",
       [](const Map& map) {
         Map darker = map.clone();
         for (int y = 0; y < map.height(); ++y) {
           for (std::size_t k = 0; k < map.row_samples(); ++k) darker.row(y)[k] /= 32;  // five stops
         }
         return darker;
       }},
      {"harmonics", irradiance_map},
  };
  std::filesystem::create_directories(argv[2]);
  for (const auto& [name, operation] : operations) {
    const Map sheet[4] = {hdr_map.clone(), operation(hdr_map), ldr_map.clone(), operation(ldr_map)};
    const hdr::Path path = hdr::Path(argv[2]) / (std::string(name) + ".png");
    // Irradiance has no highlights to clip: it is shown at its own exposure.
    const double after = std::string(name) == "harmonics" ? hdr::metered_stops(sheet[1]) + 1 : stops;
    hdr::write_picture(path, side_by_side(sheet, stops, after));
    std::cout << "wrote " << path.string() << '\n';
  }
} catch (const hdr::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
