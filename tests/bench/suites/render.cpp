// Test renders: every method's time against its error, beside Cycles.
#include "libhdr/render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "tests/bench/rivals/cycles.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/lit_scene.h"
#include "tests/bench/suites/suite.h"
#include "tests/support/scratch.h"

namespace hdr::bench {
namespace {

struct Method {
  const char* name;
  bool samples;  ///< falls with more of them; else there is but one picture
};
constexpr Method kMethods[] = {{"mc", true},     {"importance", true}, {"structured", true}, {"mis", true},
                               {"auto", true},   {"cache", true},      {"pixels", false},    {"sh", false},
                               {"sh-ao", false}, {"mean-ao", false},   {"prt", false}};
constexpr double kSane = 1e5;  // %: one sample a pixel of a sunny sky is noise, and still an answer

struct Setup {
  Scene scene;
  Environment light, compensated;
  Size size;
  RadianceMap reference;
  std::string stage;
};

Setup setup_of(const Bench& bench) {
  const int width = bench.pick(256, 1024);
  Setup setup{lit_scene(bench),
              environment_of(bench, width, false),
              environment_of(bench, width, true),
              bench.pick(Size{80, 60}, Size{400, 300}),
              {},
              {}};
  const int samples = bench.pick(512, 4096);
  setup.reference = rendered(setup.scene, setup.compensated, "mis", setup.size, samples, 77).picture;
  setup.stage = fmt::format("{} on a plane under {}, {}x{}", scene_name(bench), light_name(bench), setup.size.width,
                            setup.size.height);
  return setup;
}

Row row_of(const Setup& setup, const std::string& subject, int samples) {
  Row row{"render", setup.stage, subject, "samples"};
  row.value = samples;
  row.error_name = "relative rms, against a converged render";
  row.error_unit = "%";
  row.megapixels = megapixels(setup.size);
  return row;
}

std::vector<Contender> ours(const Bench& bench, const Setup& setup) {
  std::vector<Contender> contenders;
  const auto counts = bench.quick() ? std::vector<int>{1, 4, 16, 64} : std::vector<int>{1, 4, 16, 64, 256};
  for (const Method& method : kMethods) {
    for (const int samples : method.samples ? counts : std::vector<int>{64}) {
      const auto answer = std::make_shared<RadianceMap>();
      Row row = row_of(setup, std::string("hdr ") + method.name, samples);
      row.setting =
          fmt::format("hdr render --probe probe.exr --method {} --samples {} -o render.exr", method.name, samples);
      const bool both = std::string(method.name) == "mis" || std::string(method.name) == "auto";
      const Environment& light = both ? setup.compensated : setup.light;
      contenders.push_back({row,
                            [answer, &setup, &light, name = method.name, samples] {
                              *answer = rendered(setup.scene, light, name, setup.size, samples, 1).picture;
                            },
                            [answer, &setup] { return percent_off(*answer, setup.reference); }, kSane});
    }
  }
  return contenders;
}

/// Times are those that Blender measures of itself, without its start.
void against_cycles(Bench& bench, const Setup& setup) {
  if (!cycles_is_here()) return bench.absent("Cycles", "apt-get install blender");
  const support::ScratchFolder scratch;
  const auto counts = bench.quick() ? std::vector<int>{1, 4, 16} : std::vector<int>{1, 4, 16, 64, 256};
  try {
    for (const CyclesRun& run :
         render_by_cycles(setup.scene, setup.light.latlong(), setup.size, counts, threads(), scratch.path())) {
      Row row = row_of(setup, "Cycles", run.samples);
      row.error = percent_off(run.picture, setup.reference);
      row.threads = threads();
      if (row.error <= kSane) {
        row.cpu_seconds = row.median_cpu_seconds = run.cpu_seconds;
        row.wall_seconds = run.wall_seconds;
      } else {
        row.note = "not timed: its answer is wrong";
      }
      bench.add(row);
    }
  } catch (const Error& e) {
    bench.absent("Cycles", e.what());
  }
}

/// Mean of |a / b - 1| over blocks of pixels that b covers wholly, in percent: what is left of both pictures' noise in
/// a pixel is several times as large as in a block.
double mean_percent_between(const RadianceMap& a, const RadianceMap& b) {
  constexpr int kBlock = 4;
  double sum = 0;
  int blocks = 0;
  const auto whole = [&](int left, int top) {
    for (int k = 0; k < kBlock * kBlock; ++k)
      if (b.alpha(left + k % kBlock, top + k / kBlock) < 0.999f) return false;
    return true;
  };
  const auto light = [&](const RadianceMap& map, int left, int top) {
    double all = 0;
    for (int k = 0; k < kBlock * kBlock; ++k) {
      const float* p = map.rgb.pixel(left + k % kBlock, top + k / kBlock);
      all += luminance<double>(p[0], p[1], p[2]);
    }
    return all;
  };
  for (int top = 0; top + kBlock <= b.rgb.height(); top += kBlock) {
    for (int left = 0; left + kBlock <= b.rgb.width(); left += kBlock) {
      const double ours = light(a, left, top), theirs = light(b, left, top);
      if (!whole(left, top) || !(theirs > 0)) continue;
      sum += std::abs(ours / theirs - 1);
      ++blocks;
    }
  }
  return 100 * sum / std::max(blocks, 1);
}

/// The same picture? Both converged: orientation of the map, cosine, visibility, scale. By triangles as they are, and
/// with normals between vertices, where each hides the triangles' terminator in its own way.
void agree_with_cycles(Bench& bench, const Setup& setup) {
  if (!cycles_is_here()) return;  // said above
  const int samples = bench.pick(1024, 4096);
  const Size size = bench.pick(Size{80, 60}, Size{200, 150});
  for (const bool smooth : {false, true}) {
    Scene scene = setup.scene;
    if (!smooth)
      for (Mesh& mesh : scene.meshes) mesh.normals.clear();
    const support::ScratchFolder scratch;
    const std::vector<CyclesRun> theirs =
        render_by_cycles(scene, setup.light.latlong(), size, {samples}, threads(), scratch.path());
    Row row = row_of(setup, "hdr mis against Cycles", samples);
    row.stage = setup.stage + ", both converged";
    row.knob = "surface";
    row.label = smooth ? "smooth" : "flat";
    row.error_name = "mean relative difference of blocks of 4x4 pixels";
    row.error =
        mean_percent_between(rendered(scene, setup.compensated, "mis", size, samples, 1).picture, theirs[0].picture);
    row.megapixels = megapixels(size);
    row.note = fmt::format("{} samples each", samples);
    bench.add(row);
  }
}

void by_megapixels(Bench& bench, const Setup& setup) {
  for (const int width : bench.quick() ? std::vector<int>{40, 80, 160} : std::vector<int>{100, 200, 400, 800}) {
    const Size size{width, width * 3 / 4};
    Row row{"render", "mis, 16 samples, by size", "hdr mis", "megapixels"};
    row.value = row.megapixels = megapixels(size);
    bench.race({{row, [&] { rendered(setup.scene, setup.compensated, "mis", size, 16, 1); }}});
  }
}

void by_threads(Bench& bench, const Setup& setup) {
  Row row{"render", "mis, 16 samples, by threads", "hdr mis", "threads"};
  row.megapixels = megapixels(setup.size);
  race_threads(bench, row, [&] { rendered(setup.scene, setup.compensated, "mis", setup.size, 16, 1); });
}

}  // namespace

void render_suite(Bench& bench) {
  const Setup setup = setup_of(bench);
  bench.attempt("render", "by method", [&] { bench.race(ours(bench, setup)); });
  bench.attempt("render", "Cycles", [&] { against_cycles(bench, setup); });
  bench.attempt("render", "agreement with Cycles", [&] { agree_with_cycles(bench, setup); });
  bench.attempt("render", "by size", [&] { by_megapixels(bench, setup); });
  bench.attempt("render", "by threads", [&] { by_threads(bench, setup); });
}

}  // namespace hdr::bench
