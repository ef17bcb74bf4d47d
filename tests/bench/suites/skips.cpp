// What is skipped because a scene does not need it: the same scene with and without, the time that is saved, and what
// became of the answer.
#include <fmt/format.h>

#include <cmath>
#include <cstring>

#include "libhdr/merge/merge.h"
#include "libhdr/response/calibrate.h"
#include "tests/bench/light_truth.h"
#include "tests/bench/merged_rows.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/lit_scene.h"
#include "tests/bench/suites/photographed.h"
#include "tests/bench/suites/suite.h"

namespace hdr::bench {
namespace {

using Answer = std::function<Image<float>()>;

/// Root mean square of the difference over that of the picture, in percent.
double percent_changed(const Image<float>& with, const Image<float>& without) {
  double off = 0, size = 0;
  if (with.size() != without.size()) return kUnknown;
  for (int y = 0; y < with.height(); ++y) {
    for (std::size_t k = 0; k < with.row_samples(); ++k) {
      off += std::pow(static_cast<double>(with.row(y)[k]) - without.row(y)[k], 2);
      size += std::pow(static_cast<double>(without.row(y)[k]), 2);
    }
  }
  return size > 0 ? 100 * std::sqrt(off / size) : 0;
}

double bytes_changed(const Image<float>& with, const Image<float>& without) {
  double count = 0;
  for (int y = 0; y < with.height() && with.size() == without.size(); ++y) {
    const auto *a = reinterpret_cast<const unsigned char*>(with.row(y)),
               *b = reinterpret_cast<const unsigned char*>(without.row(y));
    for (std::size_t k = 0; k < with.row_samples() * sizeof(float); ++k) count += a[k] != b[k];
  }
  return count;
}

/// `most`: percent that the skip may change.
struct Skip {
  std::string stage, what;  ///< what is skipped; in which scene
  double most = 0;
};

void pair(Bench& bench, const Skip& skip, Size size, const Answer& with, const Answer& without) {
  Image<float> answers[2];
  Row skipping{"skips", skip.stage, "hdr, skipping", "scene"};
  skipping.label = skip.what;
  skipping.error_name = "change of the answer, rms";
  skipping.error_unit = "%";
  skipping.megapixels = megapixels(size);
  Row doing = skipping;
  doing.subject = "all done";
  const std::size_t first = bench.race(
      {{doing, [&] { answers[1] = without(); }},
       {skipping, [&] { answers[0] = with(); }, [&] { return percent_changed(answers[0], answers[1]); }, skip.most}});
  Row &all = bench.row(first), &fewer = bench.row(first + 1);
  if (!fewer.timed() || !all.timed()) return;
  fewer.note =
      fmt::format("saves {:.0f} % of the time; {} bytes differ", 100 * (1 - fewer.cpu_seconds / all.cpu_seconds),
                  short_number(bytes_changed(answers[0], answers[1])));
}

BracketPlan plan_of(Size size, const std::string& format) {
  BracketPlan plan;
  plan.size = size;
  plan.evs = uniform_evs(7, 2);
  plan.response = srgb_response(8);
  plan.format = format;
  return plan;
}

Image<float> merged(const Bracket& bracket, const Alignment& alignment, const Response& response, bool deghost) {
  MergeOptions options;
  options.deghost = deghost;
  return merge(bracket, alignment, response, options).map.rgb;
}

void of_alignment(Bench& bench, const Photographed& still) {
  const Size size = still.bracket.size();
  const Response& response = still.truth.response;
  const Alignment found = align(still.bracket, response);
  Alignment moved = found;  // by so little that nothing changes: every shot is resampled all the same
  for (FrameAlignment& frame : moved.frames) {
    frame.ref_from_photo(0, 2) += 1e-3;
    frame.skipped.clear();
  }
  moved.frames[static_cast<std::size_t>(moved.reference)].ref_from_photo = Mat3::Identity();
  pair(
      bench, {"resampling of shots that lie still", "a bracket on a tripod", 1}, size,
      [&] { return merged(still.bracket, found, response, false); },
      [&] { return merged(still.bracket, moved, response, false); });
}

/// Where the corners of each shot lie in the reference, pixels.
Image<float> corners(const Alignment& alignment, Size size) {
  Image<float> at(4, static_cast<int>(alignment.frames.size()), 3);
  for (int k = 0; k < at.height(); ++k) {
    for (int corner = 0; corner < 4; ++corner) {
      const Vec3 there = alignment.frames[static_cast<std::size_t>(k)].ref_from_photo *
                         Vec3(corner % 2 ? size.width : 0, corner / 2 ? size.height : 0, 1);
      for (int c = 0; c < 3; ++c) at(corner, k, c) = static_cast<float>(there[c] / there[2]);
    }
  }
  return at;
}

void of_search(Bench& bench, const Photographed& still) {
  const Size size = still.bracket.size();
  const auto found = [&](AlignMethod method) {
    return corners(align(still.bracket, still.truth.response, method), size);
  };
  pair(
      bench, {"searching for motion (all done: by ECC)", "a bracket on a tripod", 0.05}, size,
      [&] { return found(AlignMethod::kAuto); }, [&] { return found(AlignMethod::kEcc); });
}

void of_tiles(Bench& bench, const Photographed& jpegs, const Photographed& pngs) {
  for (const auto& [made, weight, what] : {std::tuple(&jpegs, WeightKind::kHat, "JPEGs of 16 stops"),
                                           std::tuple(&pngs, WeightKind::kVariance, "PNGs of 16 stops")}) {
    const auto rows = [&, made = made, weight = weight](RowKernel kernel) {
      return merged_rows(made->bracket, made->truth.response, weight, kernel).rgb;
    };
    pair(
        bench, {"tiles in which a shot is black or clipped", what, 0}, made->bracket.size(),
        [&] { return rows(RowKernel::kFast); }, [&] { return rows(RowKernel::kEveryTile); });
  }
}

void of_ghosts(Bench& bench, const Photographed& still) {
  const Alignment alignment = no_alignment(still.bracket);
  const Response& response = still.truth.response;
  pair(
      bench, {"looking for ghosts (without --deghost)", "nothing moves", 0}, still.bracket.size(),
      [&] { return merged(still.bracket, alignment, response, false); },
      [&] { return merged(still.bracket, alignment, response, true); });
}

void of_noise(Bench& bench, const Photographed& still) {
  const Calibration calibration = calibrate_debevec_malik(still.bracket);
  const Alignment alignment = no_alignment(still.bracket);
  MergeOptions known;
  known.noise_estimate = calibration.noise;
  pair(
      bench, {"measuring the noise again", "calibrated from the same bracket", 0.01}, still.bracket.size(),
      [&] { return merge(still.bracket, alignment, calibration.response, known).map.rgb; },
      [&] { return merge(still.bracket, alignment, calibration.response).map.rgb; });
}

/// A soft map has no energy in high degrees, and its irradiance is drawn from as few as the error allows.
void of_degrees(Bench& bench) {
  Image<float> soft = sky(bench.pick(256, 1024));
  for (int y = 0; y < soft.height(); ++y) {
    for (float* v = soft.row(y); v != soft.row(y) + soft.row_samples(); ++v) *v = std::min(*v, 2.0f);  // no sun
  }
  const ChosenSh chosen = project_within(soft, LatLong{soft.size()}, 0.02);
  const Sh all = project(soft, LatLong{soft.size()}, 12);
  const Size size{256, 128};
  pair(
      bench, {fmt::format("harmonics above degree {}, at an error of 2 %", chosen.sh.degree), "a clouded sky", 2}, size,
      [&] { return irradiance_map(chosen.sh, size); }, [&] { return irradiance_map(all, size); });
}

void of_shadow_rays(Bench& bench) {
  const Environment light = environment_of(bench, 256, true);
  const Scene alone = sphere_alone(Material{});
  Scene other = sphere_alone(Material{});
  // A speck far behind the camera: nothing is proven any more, and nothing changes.
  other.meshes.push_back(sphere_mesh(other.camera.eye * 100.0f, 1e-4f, Material{}, 3));
  const Size size = bench.pick(Size{320, 240}, Size{640, 480});
  pair(
      bench, {"shadow rays where nothing can occlude", "a convex scene", 0.01}, size,
      [&] { return rendered(alone, light, "mis", size, 32, 1).picture.rgb.clone(); },
      [&] { return rendered(other, light, "mis", size, 32, 1).picture.rgb.clone(); });
}

/// The curve is told by a few hundred points as well as by all that the shots have: exposures of all codes.
void of_points(Bench& bench, const Photographed& made) {
  const auto calibrated = [&](int points) {
    CalibrateOptions options;
    options.pixels = points;
    const Response response = calibrate_debevec_malik(made.bracket, {}, options).response;
    Image<float> curve(256, 1, 3);
    for (int c = 0; c < 3; ++c) {
      for (int code = 0; code < 256; ++code) curve(code, 0, c) = static_cast<float>(response.exposure(c, code));
    }
    return curve;
  };
  const int many = bench.pick(3000, 30000);
  pair(
      bench, {fmt::format("points of {} that calibrating does not need", many), "JPEGs of 16 stops", 5},
      made.bracket.size(), [&] { return calibrated(0); }, [&] { return calibrated(many); });
}

/// Directions for pixels that are known well enough already.
void of_converged_pixels(Bench& bench) {
  const Environment light = environment_of(bench, 256, true);
  const Scene scene = lit_scene(bench);
  RenderOptions options;
  options.method = RenderMethod::kMis;
  options.size = bench.pick(Size{200, 150}, Size{400, 300});
  options.samples = bench.pick(256, 512);
  RenderOptions enough = options;
  enough.error = 0.05;
  pair(
      bench, {fmt::format("samples of {} where a pixel is within 5 %", options.samples), scene_name(bench), 10},
      options.size, [&] { return render(scene, light, enough).picture.rgb.clone(); },
      [&] { return render(scene, light, options).picture.rgb.clone(); });
}

}  // namespace

void skips_suite(Bench& bench) {
  const Size size = bench.pick(Size{600, 400}, Size{4000, 2667});
  const Photographed jpegs = photographed(plan_of(size, "jpg")), pngs = photographed(plan_of(size, "png"));
  const auto part = [&](const char* stage, const std::function<void()>& work) { bench.attempt("skips", stage, work); };
  part("searching", [&] { of_search(bench, jpegs); });
  part("resampling", [&] { of_alignment(bench, jpegs); });
  part("tiles", [&] { of_tiles(bench, jpegs, pngs); });
  part("ghosts", [&] { of_ghosts(bench, pngs); });
  part("noise", [&] { of_noise(bench, pngs); });
  part("degrees", [&] { of_degrees(bench); });
  part("shadow rays", [&] { of_shadow_rays(bench); });
  part("points", [&] { of_points(bench, jpegs); });
  part("converged pixels", [&] { of_converged_pixels(bench); });
}

}  // namespace hdr::bench
