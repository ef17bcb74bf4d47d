// The lecture's series, drawn again: its methods on one scene, with its seconds of 2003 beside ours.
#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/filter/resize.h"
#include "libhdr/filter/tonemap.h"
#include "tests/bench/light_truth.h"
#include "tests/bench/stopwatch.h"
#include "tests/bench/suites/lecture_sheet.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/lit_scene.h"
#include "tests/bench/suites/suite.h"

namespace hdr::bench {
namespace {

struct Step {
  const char* method;
  int samples;
  const char* title;
  double seconds_2003;  ///< as the lecture prints them; 0: it prints none
  bool has_error;       ///< shows light, and not openness alone
  bool depth_maps = false;
};
/// In the lecture's order; its pictures have 400x300 pixels.
constexpr Step kSteps[] = {{"mc", 1, "Monte Carlo, 1 sample", 0.167, true},
                           {"mc", 100, "Monte Carlo, 100 samples", 4.579, true},
                           {"mc", 2500, "Monte Carlo, 2500 samples", 95.322, true},
                           {"cache", 16, "irradiance cache, 16 rays to its lamps", 15.654, true},
                           {"sh", 1, "spherical harmonics", 0.572, true},
                           {"ao", 256, "ambient occlusion, 256 rays", 21.198, false},
                           {"ao", 256, "ambient occlusion, 256 depth maps", 0, false, true},
                           {"sh-ao", 256, "harmonics x occlusion", 0, true},
                           {"mean-ao", 256, "mean colour x occlusion", 0, true},
                           {"importance", 5, "importance sampling, 5 rays", 0, true},
                           {"structured", 5, "structured sampling, 5 rays", 0, true}};

std::vector<std::string> words_of(const Step& step, const Row& row) {
  std::vector<std::string> lines = {step.title};
  std::string line = short_seconds(row.cpu_seconds) + " CPU";
  if (std::isfinite(row.error)) line += fmt::format(", error {} %", short_number(row.error));
  lines.push_back(line);
  lines.push_back(step.seconds_2003 > 0 ? fmt::format("2003: {:g} s", step.seconds_2003)
                                        : std::string("2003: no time"));
  return lines;
}

/// Black dots where records are.
Image<std::uint8_t> with_points(Image<std::uint8_t> codes, const std::vector<Vec2f>& points) {
  for (const Vec2f& p : points) {
    for (int c = 0; c < 3; ++c) codes(static_cast<int>(p.x()), static_cast<int>(p.y()), c) = 0;
  }
  return codes;
}

void series(Bench& bench) {
  const Scene scene = lit_scene(bench);
  const int map_width = bench.pick(256, 1024);
  const Environment light = environment_of(bench, map_width, false), both = environment_of(bench, map_width, true);
  const Size size = bench.pick(Size{80, 60}, Size{400, 300});
  const RadianceMap reference = rendered(scene, both, "mis", size, bench.pick(512, 4096), 77).picture;
  const double stops = metered_stops(reference.rgb);
  const std::string stage = fmt::format("{} under {}, {}x{} (the lecture: 400x300, 2003)", scene_name(bench),
                                        light_name(bench), size.width, size.height);
  std::vector<Tile> tiles;
  for (const Step& step : kSteps) {
    if (!render_method_from_name(step.method)) {
      bench.absent(fmt::format("the lecture's \"{}\"", step.title),
                   fmt::format("this build has no `hdr render --method {}`", step.method));
      continue;
    }
    Row row{"lecture", stage, std::string("hdr ") + step.method, "samples"};
    row.value = step.samples;
    row.error_name = "relative rms, against a converged render";
    row.error_unit = "%";
    row.megapixels = megapixels(size);
    row.setting = fmt::format("hdr render --probe probe.exr --method {} --{} {} -o render.exr", step.method,
                              step.depth_maps ? "depth-maps" : "samples", step.samples);
    if (step.depth_maps) row.subject += " by depth maps", row.knob = "maps";
    if (step.seconds_2003 > 0) row.note = fmt::format("2003: {:g} s", step.seconds_2003);
    RadianceMap picture;
    std::vector<Vec2f> points;
    const auto draw = [&] {
      Rendering one = rendered(scene, light, step.method, size, step.samples, 1, step.depth_maps ? step.samples : 0);
      picture = std::move(one.picture);
      points = std::move(one.cache_points);
    };
    const std::size_t index =
        bench.race({{row, draw,
                     step.has_error ? std::function<double()>([&] { return percent_off(picture, reference); })
                                    : std::function<double()>()}});
    // Openness is a share of 1, and shown as it is.
    tiles.push_back({tonemap(picture.rgb, step.has_error ? stops : 0, {}, ToneOperator::kFilmic),
                     words_of(step, bench.row(index))});
    if (!points.empty()) {
      tiles.push_back({with_points(tonemap(picture.rgb, stops, {}, ToneOperator::kFilmic), points),
                       {fmt::format("its {} points", points.size())}});
    }
  }
  tiles.push_back({tonemap(reference.rgb, stops, {}, ToneOperator::kFilmic),
                   {"converged", fmt::format("{} samples, MIS", bench.pick(512, 4096))}});
  bench.show({"lecture", stage + ": the lecture's methods, with CPU time, error, and its seconds of 2003",
              contact_sheet(tiles, 3)});
}

/// What a photograph of 8 bits keeps of a map that is exposed at `stops`.
Image<float> through_eight_bits(View<const float> map, double stops) {
  Image<float> ldr(map.size(), 3);
  const auto gain = static_cast<float>(std::exp2(stops));
  for (int y = 0; y < map.height(); ++y) {
    for (int k = 0; k < 3 * map.width(); ++k) {
      ldr.row(y)[k] = std::round(std::min(1.0f, map.row(y)[k] * gain) * 255) / 255 / gain;
    }
  }
  return ldr;
}

/// The lecture's "HDRI and LDRI before and after filtering": harmonics of a picture that has been cut at white.
void filtered_maps(Bench& bench) {
  const Image<float> map = light_map(bench, bench.pick(512, 1024));
  const double stops = metered_stops(map);
  const Image<float> ldr = through_eight_bits(map, stops);
  const Size size{320, 160};
  const std::vector<Vec3> normals = spiral(300);
  const std::vector<Rgb> truth = irradiance_truth(map, normals);
  std::vector<Tile> tiles;
  double view_stops = 0;
  for (const auto& [name, source] : {std::pair("HDR", &map), std::pair("8 bits", &ldr)}) {
    Row row{"lecture", "harmonics of degree 2 of HDR and 8-bit maps", std::string("hdr, map in ") + name, "degree"};
    row.value = 2;
    row.error_name = "rms of irradiance over all normals";
    row.error_unit = "%";
    row.megapixels = megapixels(map.size());
    Sh sh;
    const Image<float>& light = *source;
    const std::size_t index = bench.race({{row, [&] { sh = project(light, LatLong{light.size()}, 2); },
                                           [&] {
                                             std::vector<Rgb> answer;
                                             for (const Vec3& n : normals) answer.push_back(irradiance(sh, n));
                                             return 100 * rms_of_luminance(answer, truth);
                                           }}});
    const Image<float> filtered = irradiance_map(sh, size);
    if (tiles.empty()) view_stops = metered_stops(filtered);
    tiles.push_back({tonemap(resize(light, size), stops, {}, ToneOperator::kClip), {fmt::format("map in {}", name)}});
    tiles.push_back({tonemap(filtered, view_stops, {}, ToneOperator::kFilmic),
                     {fmt::format("its irradiance, {} % off", short_number(bench.row(index).error))}});
  }
  bench.show({"lecture-maps", "a map in HDR and in 8 bits, before and after filtering by nine harmonics",
              contact_sheet(tiles, 2)});
}

}  // namespace

void lecture_suite(Bench& bench) {
  bench.attempt("lecture", "the series", [&] { series(bench); });
  bench.attempt("lecture", "filtered maps", [&] { filtered_maps(bench); });
}

}  // namespace hdr::bench
