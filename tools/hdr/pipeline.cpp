#include "tools/hdr/pipeline.h"

#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "libhdr/core/version.h"
#include "libhdr/io/output_file.h"
#include "tools/hdr/flat_field.h"
#include "tools/hdr/scale_step.h"

namespace hdr::tools {
namespace {

std::size_t shot_of_input(const Bracket& bracket, std::size_t k) {
  return static_cast<std::size_t>(bracket.input_order[k]);
}

Json flat(const Mat3& m) {
  Json numbers = Json::array();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) numbers.push_back(m(r, c));
  }
  return numbers;
}

}  // namespace

void MergePipelineOptions::declare(CLI::App& app) {
  shots.declare(app);
  merge.declare(app);
  scale.declare(app);
  calibrate.declare(app);
  app.add_option("--align", align, "auto, none, mtb, ecc or features")->capture_default_str();
}

Bracket read_shots(Run& run, const ShotsOptions& options) {
  Bracket bracket = run.stage("read", [&] { return read_bracket(options.files, options.bracket_options()); });
  for (const std::string& warning : bracket.warnings) run.warn(warning);
  return bracket;
}

std::optional<Response> known_response(const std::string& text, int bits) {
  if (text == "fit") return std::nullopt;
  if (auto named = response_from_name(text, bits)) return named;
  Response response = response_from_json(read_text(text), text);
  if (response.bits != bits) {
    throw Error(
        fmt::format("{}: a response for {}-bit codes, but the shots have {} bits; calibrate on shots of this camera "
                    "mode",
                    text, response.bits, bits));
  }
  return response;
}

Alignment align_shots(Run& run, const Bracket& bracket, const std::optional<Response>& known, AlignMethod method) {
  Alignment alignment = run.stage("align", [&] {
    if (method == AlignMethod::kNone || bracket.shots.size() < 2) return no_alignment(bracket);
    return align(bracket, known ? *known : provisional_response(bracket), method);
  });
  if (method == AlignMethod::kNone) {
    run.clock.skipped("--align none");
  } else if (bracket.shots.size() < 2) {
    run.clock.skipped("one shot, nothing to register");
  } else if (alignment.identity()) {
    double bound = 0;
    for (const FrameAlignment& frame : alignment.frames) bound = std::max(bound, frame.residual_px);
    run.clock.skipped(fmt::format("resampling: the shots are registered already, within {:.2f} px", bound));
  }
  return alignment;
}

Calibration calibrate_shots(Run& run, const Bracket& bracket, const Alignment& alignment,
                            const CalibrateOptions& options) {
  Calibration calibration = run.stage("calibrate", [&] {
    return calibrate_debevec_malik(bracket, alignment.identity() ? std::vector<Mat3>{} : alignment.ref_from_photo(),
                                   options);
  });
  for (const std::string& warning : calibration.warnings) run.warn(warning);
  if (!calibration.converged) run.warn("the response fit did not converge; look at the curve before using it");
  return calibration;
}

MergeResult merge_shots(Run& run, const MergePipelineOptions& options) {
  const AlignMethod method = align_method(options.align);
  options.scale.check();
  const MapScale like = scale_like(options.scale);
  Bracket bracket = read_shots(run, options.shots);
  require_same_terms(options.scale, like, bracket);
  const std::optional<Response> known = known_response(options.merge.response, bracket.bits());
  Alignment alignment = align_shots(run, bracket, known, method);
  Response response;
  std::optional<double> rms_log_error;
  if (known) {
    response = *known;
    run.stage("calibrate", [] {});
    run.clock.skipped("the response was given");
  } else {
    Calibration calibration = calibrate_shots(run, bracket, alignment, options.calibrate.options());
    answer_calibration(run, bracket, calibration);
    rms_log_error = calibration.rms_log_error;
    for (std::size_t k = 0; k < bracket.shots.size(); ++k) bracket.shots[k].exposure.seconds = calibration.seconds[k];
    response = std::move(calibration.response);
  }
  MergeOptions merge_options = options.merge.options();
  merge_options.exposure_unit = like.exposure_unit;
  const Image<float> flat = read_flat_field(run, options.merge.flat, response, bracket.size());
  merge_options.flat = flat;
  Merged merged = run.stage("merge", [&] { return merge(bracket, alignment, response, merge_options); });
  for (std::size_t k = 0; k < merged.frames.size(); ++k) {
    if (merged.frames[k].used) continue;
    run.clock.skipped(bracket.shots[k].path.filename().string() + " (" + merged.frames[k].skipped + ")");
  }
  merged.map.white_luminance = white_luminance_of(run, options.scale, like, bracket, merged);
  return {std::move(bracket), std::move(response), rms_log_error, std::move(alignment), std::move(merged)};
}

Provenance provenance_of(const Run& run, const Path& input) {
  Provenance provenance;
  provenance.add("version", kVersion);
  if (!run.options.empty()) provenance.add("options", run.options);
  if (!input.empty()) provenance.add("input", input.filename().string());
  return provenance;
}

Provenance provenance_of(const Run& run, const MergeResult& result) {
  const Bracket& bracket = result.bracket;
  Provenance provenance = provenance_of(run, Path{});
  std::string inputs, exposures;
  for (const Photo& shot : bracket.shots) {
    inputs += (inputs.empty() ? "" : " ") + shot.path.filename().string();
    exposures += fmt::format("{}{}", exposures.empty() ? "" : " ", shot.relative_exposure());
  }
  provenance.add("input", inputs);
  provenance.add("exposures", exposures);
  provenance.add("exposure_terms", text_from_terms(exposure_terms(bracket)));
  provenance.add("exposure_unit", fmt::format("{}", result.merged.exposure_unit));
  return provenance;
}

void answer_calibration(Run& run, const Bracket& bracket, const Calibration& calibration) {
  run.answer["rms_log_error"] = calibration.rms_log_error;
  run.answer["converged"] = calibration.converged;
  run.answer["smoothness"] = calibration.smoothness;
  run.answer["pixels"] = calibration.pixels;
  Json exposures = Json::array();
  for (std::size_t k = 0; k < bracket.shots.size(); ++k) {
    const Photo& shot = bracket.shots[shot_of_input(bracket, k)];
    exposures.push_back({{"path", shot.path.string()},
                         {"seconds", *shot.exposure.seconds},
                         {"refined_seconds", calibration.seconds[shot_of_input(bracket, k)]},
                         {"relative_exposure", shot.relative_exposure()}});
  }
  run.answer["exposures"] = std::move(exposures);
  run.say(fmt::format("response: rms {:.4f} (ln) over {} pixels, smoothness {:.3g}", calibration.rms_log_error,
                      calibration.pixels, calibration.smoothness));
}

void answer_alignment(Run& run, const Bracket& bracket, const Alignment& alignment) {
  run.answer["reference"] = bracket.shots[static_cast<std::size_t>(alignment.reference)].path.string();
  Json frames = Json::array();
  for (std::size_t k = 0; k < bracket.shots.size(); ++k) {
    const std::size_t shot = shot_of_input(bracket, k);
    const FrameAlignment& frame = alignment.frames[shot];
    Json row = {{"path", bracket.shots[shot].path.string()},
                {"ref_from_photo", flat(frame.ref_from_photo)},
                {"residual_px", frame.residual_px}};
    if (!frame.skipped.empty()) row["skipped"] = frame.skipped;
    frames.push_back(std::move(row));
    run.say(fmt::format("{}: moved {:+.2f} {:+.2f} px, within {:.2f} px{}",
                        bracket.shots[shot].path.filename().string(), frame.ref_from_photo(0, 2),
                        frame.ref_from_photo(1, 2), frame.residual_px,
                        frame.skipped.empty() ? "" : " (" + frame.skipped + ")"));
  }
  run.answer["frames"] = std::move(frames);
}

void answer_merge(Run& run, const MergeResult& result) {
  const Bracket& bracket = result.bracket;
  run.answer["width"] = result.merged.map.rgb.width();
  run.answer["height"] = result.merged.map.rgb.height();
  run.answer["clipped"] = result.merged.clipped;
  run.answer["dark"] = result.merged.dark;
  run.answer["stops"] = result.merged.stops;
  run.answer["exposure_unit"] = result.merged.exposure_unit;
  answer_white_luminance(run, result.merged.map.white_luminance);
  run.answer["reference"] = bracket.shots[static_cast<std::size_t>(result.alignment.reference)].path.string();
  Json frames = Json::array();
  for (std::size_t k = 0; k < bracket.shots.size(); ++k) {
    const std::size_t shot = shot_of_input(bracket, k);
    const FrameAlignment& aligned = result.alignment.frames[shot];
    const MergedFrame& merged = result.merged.frames[shot];
    Json row = {{"path", bracket.shots[shot].path.string()},
                {"seconds", *bracket.shots[shot].exposure.seconds},
                {"used", merged.used},
                {"ref_from_photo", flat(aligned.ref_from_photo)},
                {"residual_px", aligned.residual_px}};
    if (!merged.skipped.empty()) row["skipped"] = merged.skipped;
    if (!aligned.skipped.empty()) row["registration"] = aligned.skipped;
    frames.push_back(std::move(row));
  }
  run.answer["frames"] = std::move(frames);
  run.say(fmt::format("map: {}x{}, {:.1f} stops, {} pixels clipped and {} dark in every shot",
                      result.merged.map.rgb.width(), result.merged.map.rgb.height(), result.merged.stops,
                      result.merged.clipped, result.merged.dark));
}

}  // namespace hdr::tools
