// Brackets that nobody would take: black, clipped, of one code, falling where they should rise, exposures 2^40 apart,
// single pixels and columns. Calibrating, aligning and merging end with an Error in words or with finite numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <variant>

#include "libhdr/align/align.h"
#include "libhdr/core/parallel.h"
#include "libhdr/merge/merge.h"
#include "libhdr/response/calibrate.h"
#include "libhdr/response/estimate_noise.h"
#include "libhdr/response/expose.h"
#include "libhdr/response/fragments.h"
#include "libhdr/response/response_file.h"
#include "tests/stress/hostile.h"

namespace hdr::stress {
namespace {

void expect_response(const Response& response) {
  RC_ASSERT(response.levels() == response_levels(response.bits));
  const auto middle = static_cast<std::size_t>(response.levels() / 2);
  for (const std::vector<double>& g : response.g) {
    for (std::size_t k = 0; k < g.size(); ++k) {
      RC_ASSERT(std::isfinite(g[k]));
      RC_ASSERT(k == 0 || g[k] >= g[k - 1]);
    }
    RC_ASSERT(std::abs(g[middle]) < 1e-9);
  }
}

RC_GTEST_PROP(BracketStress, CalibratingEndsInACurveOrInWords, ()) {
  const BracketCase plan = *any_bracket(20);
  const Bracket bracket = made(plan);
  CalibrateOptions options;
  options.refine_times = *rc::gen::element(false, true);
  options.pixels = *rc::gen::element(0, 1, 30);
  if (*rc::gen::element(false, true)) options.smoothness = *rc::gen::element(0.0, 1e-12, 1.0, 1e12);
  const auto method = static_cast<CalibrateMethod>(*rc::gen::inRange(0, 3));
  try {
    const Calibration calibration = calibrate(method, bracket, {}, options);
    expect_response(calibration.response);
    RC_ASSERT(std::isfinite(calibration.rms_log_error) && calibration.rms_log_error >= 0);
    for (const std::vector<double>& deviation : calibration.deviation) {
      for (const double d : deviation) RC_ASSERT(std::isfinite(d) && d >= 0);
    }
    for (const double seconds : calibration.seconds) RC_ASSERT(std::isfinite(seconds) && seconds > 0);
    // What was found can be written, and read again.
    const Path name = *rc::gen::element("r.json", "r.m", "r.csv");
    const std::string text = text_from_response(calibration.response, name, calibration.rms_log_error);
    RC_TAG(plan.kind);
    try {
      expect_response(response_from_text(text, name, plan.bits));
    } catch (const Error& e) {
      RC_FAIL(std::string("what was written cannot be read: ") + e.what());
    }
  } catch (const Error& e) {
    RC_ASSERT(std::strlen(e.what()) > 10u);
  }
}

RC_GTEST_PROP(BracketStress, NoiseIsPositive, ()) {
  const BracketCase plan = *any_bracket(24);
  const NoiseEstimate estimate = estimate_noise(made(plan), {}, srgb_response(plan.bits));
  for (const NoiseModel& model : estimate.noise) {
    RC_ASSERT(std::isfinite(model.full_well) && model.full_well > 0);
    RC_ASSERT(std::isfinite(model.read_noise) && model.read_noise >= 0);
    RC_ASSERT(std::isfinite(model.code_noise) && model.code_noise >= 0);
  }
  RC_ASSERT(estimate.outliers >= 0 && estimate.outliers <= 1);
}

// Never NaN, infinite or negative, and the same bytes for 1 to 64 threads.
RC_GTEST_PROP(BracketStress, MergingGivesLight, ()) {
  const BracketCase plan = *any_bracket(24);
  const Bracket bracket = made(plan);
  MergeOptions options;
  options.weight = static_cast<WeightKind>(*rc::gen::inRange(0, 3));
  options.deghost = *rc::gen::element(false, true);
  options.drift = *rc::gen::element(false, true);
  options.uncertainty = true;
  Alignment alignment = no_alignment(bracket);
  if (*rc::gen::element(false, true)) {
    alignment.frames.back().ref_from_photo(0, 2) = *rc::gen::element(0.5, -3.25, 1000.0);
    alignment.frames.back().ref_from_photo(0, 1) = *rc::gen::element(0.0, 1e-3);
  }
  const Response response = srgb_response(plan.bits);
  const auto merged = [&](int thread_count) {
    set_threads(thread_count);
    Merged result = merge(bracket, alignment, response, options);
    set_threads(0);
    return result;
  };
  try {
    const Merged one = merged(1);
    RC_ASSERT(fault_of(one.map.rgb) == "");
    RC_ASSERT(fault_of(one.map.stddev) == "");
    RC_ASSERT(std::isfinite(one.stops) && std::isfinite(one.exposure_unit));
    const Merged many = merged(*rc::gen::inRange(2, 65));
    for (int y = 0; y < plan.height; ++y) {
      RC_ASSERT(std::memcmp(one.map.rgb.row(y), many.map.rgb.row(y), one.map.rgb.row_samples() * sizeof(float)) == 0);
    }
  } catch (const Error& e) {
    RC_ASSERT(std::strlen(e.what()) > 10u);
  }
}

// Where shots that see nothing outvote one that sees a little, the likeliest light is little, and not less than none.
RC_GTEST_PROP(BracketStress, MostlyBlackIsNotLessThanBlack, ()) {
  BracketCase plan;
  plan.width = 16;
  plan.height = 4;
  plan.shots = *rc::gen::inRange(2, 9);
  plan.bits = *rc::gen::element(8, 12, 16);
  plan.stops_apart = *rc::gen::element(0.1, 0.5, 2.0);
  plan.seed = *rc::gen::inRange<std::uint64_t>(0, 10000);
  Bracket bracket = made(plan);
  const int seen = *rc::gen::inRange(0, plan.shots), code = *rc::gen::inRange(1, 6);
  for (int j = 0; j < plan.shots; ++j) {
    const auto fill = [&](auto& codes) {
      for (int y = 0; y < plan.height; ++y) std::fill_n(codes.row(y), codes.row_samples(), j == seen ? code : 0);
    };
    std::visit(fill, bracket.shots[static_cast<std::size_t>(j)].codes);
  }
  MergeOptions options;
  options.uncertainty = true;
  const Merged merged = merge(bracket, no_alignment(bracket), srgb_response(plan.bits), options);
  RC_ASSERT(fault_of(merged.map.rgb) == "");
  RC_ASSERT(fault_of(merged.map.stddev) == "");
}

// The same light whatever unit the exposures are in: times of 2^-20 s or of 2^20 s.
RC_GTEST_PROP(BracketStress, TheUnitOfTimeIsNoMatter, ()) {
  BracketCase plan = *any_bracket(16);
  plan.shots = std::max(plan.shots, 2);
  plan.stops_apart = 2;
  const Bracket bracket = made(plan);
  Bracket slow = made(plan);
  const double factor = std::exp2(*rc::gen::element(-20, -1, 1, 20));
  for (Photo& shot : slow.shots) shot.exposure.seconds = *shot.exposure.seconds * factor;
  const Response response = srgb_response(plan.bits);
  const Merged a = merge(bracket, no_alignment(bracket), response), b = merge(slow, no_alignment(slow), response);
  for (int y = 0; y < plan.height; ++y) {
    for (std::size_t k = 0; k < a.map.rgb.row_samples(); ++k) {
      RC_ASSERT(std::abs(a.map.rgb.row(y)[k] - b.map.rgb.row(y)[k]) <= 1e-6f * a.map.rgb.row(y)[k]);
    }
  }
}

// A camera before anything: codes within their depth, more light never a smaller code.
RC_GTEST_PROP(BracketStress, ThereIsACodeForAnyLight, ()) {
  const MapPlan plan = *any_map(24);
  Image<float> scene = made(plan);
  if (*rc::gen::element(false, true)) spoil(scene, plan.seed);
  const int bits = *rc::gen::element(8, 10, 12, 16);
  const auto response = *rc::gen::element<std::string>("linear", "srgb", "gamma:0.1", "gamma:10", "film");
  NoiseModel silent;
  silent.read_noise = 0;
  silent.full_well = 1e30;
  const Sensor sensor{*response_from_name(response, bits), silent, *power_of_ten(-12, 12)};
  Exposure low, high;
  low.seconds = *power_of_ten(-12, 12);
  high.seconds = *low.seconds * *power_of_ten(0, 12);
  const Photo dark = expose(scene, low, sensor, 1), bright = expose(scene, high, sensor, 1);
  std::visit(
      [&](const auto& d) {
        const auto& b = std::get<std::decay_t<decltype(d)>>(bright.codes);
        for (int y = 0; y < scene.height(); ++y) {
          for (std::size_t k = 0; k < d.row_samples(); ++k) {
            RC_ASSERT(d.row(y)[k] <= b.row(y)[k]);
            RC_ASSERT(int{b.row(y)[k]} <= bright.max_code());
          }
        }
      },
      dark.codes);
}

RC_GTEST_PROP(BracketStress, FragmentsAreFinite, ()) {
  const BracketCase plan = *any_bracket(24);
  for (const auto& fragments : curve_fragments(made(plan), {}, srgb_response(plan.bits), {}, 20)) {
    for (const CurveFragment& fragment : fragments) {
      RC_ASSERT(std::isfinite(fragment.ln_radiance) && fragment.codes.size() == fragment.ln_exposure.size());
    }
  }
}

RC_GTEST_PROP(BracketStress, AligningEndsInMotionsOrInWords, ()) {
  const BracketCase plan = *any_bracket(40);
  const Bracket bracket = made(plan);
  const auto method = static_cast<AlignMethod>(*rc::gen::inRange(0, 5));
  try {
    const Alignment alignment = align(bracket, srgb_response(plan.bits), method);
    RC_ASSERT(alignment.frames.size() == bracket.shots.size());
    for (const FrameAlignment& frame : alignment.frames) {
      RC_ASSERT(frame.ref_from_photo.allFinite() && std::isfinite(frame.residual_px));
      RC_ASSERT(std::abs(frame.ref_from_photo.determinant()) > 1e-3);
    }
  } catch (const Error& e) {
    RC_ASSERT(std::strlen(e.what()) > 10u);
  }
}

}  // namespace
}  // namespace hdr::stress
