#include "tools/hdr/pipeline.h"

#include <fmt/format.h>

#include <algorithm>

#include "libhdr/core/error.h"
#include "libhdr/core/rows.h"
#include "libhdr/core/version.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/write.h"
#include "libhdr/response/response_file.h"
#include "tools/hdr/camera_field.h"
#include "tools/hdr/flat_field.h"
#include "tools/hdr/map_digest.h"
#include "tools/hdr/scale_step.h"
#include "tools/hdr/shots_output.h"

namespace hdr::tools {
namespace {

std::size_t shot_of_input(const Bracket& bracket, std::size_t k) {
  return static_cast<std::size_t>(bracket.input_order[k]);
}

/// Bytes of codes for each pixel of a shot. A merge may use 2.5 times its float map, 30 bytes a pixel; what is left is
/// for a band of the map, for its compression, and for the small pictures of the alignment.
constexpr double kCodeBytesAPixel = 27;

/// Hands the rows on, and has the time taken.
template <class Timed>
class TimedSink final : public MapSink {
 public:
  TimedSink(MapSink& to, const Timed& timed) : to_(to), timed_(timed) {}
  void put(const MapRows& rows) override {
    timed_([&] { to_.put(rows); });
  }

 private:
  MapSink& to_;
  const Timed& timed_;
};

void tell_skipped(Run& run, const Bracket& bracket, const Merged& merged) {
  for (std::size_t k = 0; k < merged.frames.size(); ++k) {
    const MergedFrame& frame = merged.frames[k];
    const std::string& why = frame.used ? frame.limited : frame.skipped;
    if (!why.empty()) run.clock.skipped(bracket.shots[k].path.filename().string() + " (" + why + ")");
  }
  if (merged.skipped_tiles > 0) {
    run.clock.skipped(
        fmt::format("{:.0f} % of the shots' tiles had nothing to add (black or clipped): not a byte changes",
                    100 * merged.skipped_tiles));
  }
}

void write_ghost_mask(const MergeInputs& inputs, const MergeSummary& merged) {
  if (inputs.ghost_mask.empty()) return;
  const View<const std::uint8_t> mask = merged.ghosts.mask;
  if (Path(inputs.ghost_mask).extension() == ".exr") {  // to be read beside the map: 1 where a shot is left out
    RadianceMap map;
    map.rgb = Image<float>(inputs.bracket.size(), 3);
    for (int y = 0; y < mask.height(); ++y) {
      for (int x = 0; x < mask.width(); ++x) std::fill_n(map.rgb.pixel(x, y), 3, static_cast<float>(mask(x, y)) / 255);
    }
    write_map(inputs.ghost_mask, map);
    return;
  }
  Image<std::uint8_t> picture(inputs.bracket.size(), 3);
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) std::fill_n(picture.pixel(x, y), 3, mask(x, y));
  }
  write_picture(inputs.ghost_mask, picture);
}

/// What --deghost did.
Json ghosts_as_json(const Bracket& bracket, const Ghosts& ghosts) {
  const auto path = [&](int shot) { return bracket.shots[static_cast<std::size_t>(shot)].path.string(); };
  Json regions = Json::array();
  for (const GhostRegion& region : ghosts.regions) {
    Json left_out = Json::array();
    for (const int shot : region.left_out) left_out.push_back(path(shot));
    regions.push_back({{"box", {region.x0, region.y0, region.x1, region.y1}},
                       {"pixels", region.pixels},
                       {"reference", path(region.reference)},
                       {"left_out", std::move(left_out)}});
  }
  return {{"share", ghosts.share}, {"regions", std::move(regions)}};
}

Json flat(const Mat3& m) {
  Json numbers = Json::array();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) numbers.push_back(m(r, c));
  }
  return numbers;
}

/// --response, or what the shots' folder says of it. What decides pixels belongs in the provenance, wherever it stands.
std::string response_text(Run& run, const MergePipelineOptions& options) {
  if (options.merge.response != "auto") return options.merge.response;
  const std::optional<std::string> noted = response_of_folder(expand_shots(options.shots.files));
  if (!noted) return "fit";
  run.options += (run.options.empty() ? "" : " ") + ("--response " + Path(*noted).filename().string());
  return *noted;
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
  BracketOptions bracket_options = options.bracket_options();
  bracket_options.code_bytes_a_pixel = kCodeBytesAPixel;
  Bracket bracket = run.stage("read", [&] { return read_bracket(options.files, bracket_options); });
  const auto kept =
      std::count_if(bracket.shots.begin(), bracket.shots.end(), [](const Photo& p) { return p.in_memory(); });
  if (static_cast<std::size_t>(kept) < bracket.shots.size()) {
    run.clock.skipped(
        fmt::format("keeping codes in memory: of {} shots x {:.1f} MP for {}, as all would exceed 2.5 x the map; each "
                    "stage decodes "
                    "these again",
                    bracket.shots.size(), 1e-6 * bracket.size().width * bracket.size().height,
                    bracket.shots.size() - static_cast<std::size_t>(kept)));
  }
  for (const std::string& warning : bracket.warnings) run.warn(warning);
  return bracket;
}

std::optional<Response> known_response(const std::string& text, int bits) {
  if (text == "fit") return std::nullopt;
  if (auto named = response_from_name(text, bits)) return named;
  Response response = response_from_text(read_text(text), text, bits);
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

Calibration calibrate_shots(Run& run, const Bracket& bracket, const Alignment& alignment, const CalibrateFlags& flags) {
  Calibration calibration = run.stage("calibrate", [&] {
    return calibrate(calibrate_method_from_name(flags.method).value(), bracket,
                     alignment.identity() ? std::vector<Mat3>{} : alignment.ref_from_photo(), flags.options());
  });
  for (const std::string& warning : calibration.warnings) run.warn(warning);
  if (!calibration.converged) run.warn("the response fit did not converge; look at the curve before using it");
  return calibration;
}

MergeInputs prepare_merge(Run& run, const MergePipelineOptions& options) {
  const AlignMethod method = align_method(options.align);
  options.scale.check();
  MergeInputs inputs;
  inputs.scale = options.scale;
  const MapScale like = scale_like(options.scale);
  ShotsOptions shots_options = options.shots;
  shots_options.expects_motion = options.merge.deghost;
  inputs.bracket = read_shots(run, shots_options);
  require_same_terms(options.scale, like, inputs.bracket);
  const std::string response = options.given_response ? "of the first bracket" : response_text(run, options);
  const std::optional<Response> known =
      options.given_response ? options.given_response : known_response(response, inputs.bracket.bits());
  inputs.alignment = align_shots(run, inputs.bracket, known, method);
  inputs.options = options.merge.options();
  inputs.ghost_mask = options.merge.ghost_mask;
  if (known) {
    inputs.response = *known;
    run.stage("calibrate", [] {});
    run.clock.skipped(options.given_response ? "the response is that of the first bracket"
                      : options.merge.response == "auto"
                          ? "the response is in bracket.json: " + Path(response).filename().string()
                          : "the response was given");
  } else {
    Calibration calibration = calibrate_shots(run, inputs.bracket, inputs.alignment, options.calibrate);
    answer_calibration(run, inputs.bracket, calibration);
    for (std::size_t k = 0; k < calibration.seconds.size(); ++k) {
      inputs.bracket.shots[k].exposure.seconds = calibration.seconds[k];  // as refined
    }
    inputs.options.noise_estimate = calibration.noise;
    inputs.response = calibration.response;
    inputs.fit = std::move(calibration);
  }
  inputs.flat = read_flat_field(run, options.merge.flat, inputs.response, inputs.bracket.size());
  inputs.options.flat = inputs.flat;
  inputs.options.exposure_unit = like.exposure_unit;
  if (options.given_unit) inputs.options.exposure_unit = options.given_unit;
  // The header of a map that is written as it is merged needs the unit beforehand.
  const std::vector<Photo>& shots = inputs.bracket.shots;
  if (!inputs.options.exposure_unit) inputs.options.exposure_unit = shots[(shots.size() - 1) / 2].relative_exposure();
  inputs.white_luminance = known_white_luminance(options.scale, like, inputs.bracket, *inputs.options.exposure_unit);
  return inputs;
}

Merged merge_shots(Run& run, const MergeInputs& inputs, MapSink* digest) {
  MergeOptions merge_options = inputs.options;
  merge_options.uncertainty = inputs.options.uncertainty || digest;
  Merged merged =
      run.stage("merge", [&] { return merge(inputs.bracket, inputs.alignment, inputs.response, merge_options); });
  if (digest) digest->put({0, merged.map.rgb, merged.map.stddev, merged.flags});
  if (!inputs.options.uncertainty) {
    merged.map.stddev = {};
    merged.flags = {};
  }
  tell_skipped(run, inputs.bracket, merged);
  write_ghost_mask(inputs, merged);
  merged.map.white_luminance =
      inputs.scale.patch.empty() ? inputs.white_luminance : white_luminance_of_patch(run, inputs.scale, merged.map.rgb);
  return merged;
}

Merged merge_to_file(Run& run, const MergeInputs& inputs, const Path& output, const WriteOptions& options,
                     MapSink* digest) {
  if (!inputs.scale.patch.empty()) {  // measured in the map, and said in its header: the map comes first
    Merged merged = merge_shots(run, inputs, digest);
    run.stage("write", [&] { write_map(output, merged.map, provenance_of_map(run, inputs), options); });
    return merged;
  }
  double write_seconds = 0, write_cpu_seconds = 0;
  const auto timed = [&](const auto& work) {
    const Stopwatch watch;
    work();
    write_seconds += watch.seconds();
    write_cpu_seconds += watch.cpu_seconds();
  };
  Merged merged;
  static_cast<MergeSummary&>(merged) = run.stage("merge", [&] {
    const bool uncertainty = inputs.options.uncertainty;
    const MapHeader header{inputs.bracket.size(), {}, inputs.white_luminance, {}, uncertainty, uncertainty};
    const auto writer = open_map_rows(output, header, provenance_of_map(run, inputs), options);
    TimedSink timed_sink(*writer, timed);
    DigestingSink sink(digest, timed_sink, uncertainty);
    MergeOptions merge_options = inputs.options;
    merge_options.uncertainty = uncertainty || digest;
    MergeSummary summary = merge_rows(inputs.bracket, inputs.alignment, inputs.response, merge_options, sink);
    timed([&] { writer->finish(); });
    return summary;
  });
  merged.map.white_luminance = inputs.white_luminance;
  tell_skipped(run, inputs.bracket, merged);
  write_ghost_mask(inputs, merged);
  run.clock.split("write", write_seconds, write_cpu_seconds);
  return merged;
}

Provenance provenance_of(const Run& run, const Path& input) {
  Provenance provenance;
  provenance.add("version", kVersion);
  if (!run.options.empty()) provenance.add("options", run.options);
  if (!input.empty()) provenance.add("input", input.filename().string());
  return provenance;
}

Provenance provenance_of(const Run& run, const MergeInputs& inputs) {
  const Bracket& bracket = inputs.bracket;
  Provenance provenance = provenance_of(run, Path{});
  std::string names, exposures;
  for (const Photo& shot : bracket.shots) {
    names += (names.empty() ? "" : " ") + shot.path.filename().string();
    exposures += fmt::format("{}{}", exposures.empty() ? "" : " ", shot.relative_exposure());
  }
  provenance.add("input", names);
  provenance.add("exposures", exposures);
  provenance.add("exposure_terms", text_from_terms(exposure_terms(bracket)));
  provenance.add("exposure_unit", fmt::format("{}", inputs.options.exposure_unit.value()));
  return provenance;
}

Provenance provenance_of_map(const Run& run, const MergeInputs& inputs) {
  Provenance provenance = provenance_of(run, inputs);
  const Photo& reference = inputs.bracket.shots.at(static_cast<std::size_t>(inputs.alignment.reference));
  if (const auto fov = camera_field(reference.path.string(), reference.size())) {
    provenance.add("camera_fov", fmt::format("{}", *fov));
  }
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
                {"residual_px", frame.residual_px},
                {"inliers", frame.inliers}};
    if (!frame.skipped.empty()) row["skipped"] = frame.skipped;
    frames.push_back(std::move(row));
    run.say(fmt::format("{}: moved {:+.2f} {:+.2f} px, within {:.2f} px{}",
                        bracket.shots[shot].path.filename().string(), frame.ref_from_photo(0, 2),
                        frame.ref_from_photo(1, 2), frame.residual_px,
                        frame.skipped.empty() ? "" : " (" + frame.skipped + ")"));
  }
  run.answer["frames"] = std::move(frames);
}

void answer_merge(Run& run, const MergeInputs& inputs, const Merged& merged) {
  const Bracket& bracket = inputs.bracket;
  run.answer["width"] = bracket.size().width;
  run.answer["height"] = bracket.size().height;
  run.answer["clipped"] = merged.clipped;
  run.answer["dark"] = merged.dark;
  run.answer["stops"] = merged.stops;
  run.answer["exposure_unit"] = merged.exposure_unit;
  answer_white_luminance(run, merged.map.white_luminance);
  run.answer["reference"] = bracket.shots[static_cast<std::size_t>(inputs.alignment.reference)].path.string();
  Json frames = Json::array();
  for (std::size_t k = 0; k < bracket.shots.size(); ++k) {
    const std::size_t shot = shot_of_input(bracket, k);
    const FrameAlignment& aligned = inputs.alignment.frames[shot];
    const MergedFrame& used = merged.frames[shot];
    Json row = {{"path", bracket.shots[shot].path.string()},
                {"seconds", *bracket.shots[shot].exposure.seconds},
                {"used", used.used},
                {"ref_from_photo", flat(aligned.ref_from_photo)},
                {"residual_px", aligned.residual_px},
                {"inliers", aligned.inliers}};
    if (!used.skipped.empty()) row["skipped"] = used.skipped;
    if (!used.limited.empty()) row["limited"] = used.limited;
    if (!aligned.skipped.empty()) row["registration"] = aligned.skipped;
    if (inputs.options.drift) {
      row["gain"] = used.gain.gain;
      row["gain_deviation"] = used.gain.deviation ? Json(*used.gain.deviation) : Json();
      if (!used.gain.deviation) row["gain_unknown"] = used.gain.unknown;
      run.say(fmt::format("{}: gain {:.4f} {}", bracket.shots[shot].path.filename().string(), used.gain.gain,
                          used.gain.deviation ? fmt::format("+- {:.4f}", *used.gain.deviation)
                                              : "(not known: " + used.gain.unknown + ")"));
    }
    frames.push_back(std::move(row));
  }
  run.answer["frames"] = std::move(frames);
  if (inputs.options.deghost) {
    run.answer["deghost"] = ghosts_as_json(bracket, merged.ghosts);
    run.say(fmt::format("ghosts: {} regions, {:.2f} % of the pixels", merged.ghosts.regions.size(),
                        100 * merged.ghosts.share));
  }
  run.say(fmt::format("map: {}x{}, {:.1f} stops, {} pixels clipped and {} dark in every shot", bracket.size().width,
                      bracket.size().height, merged.stops, merged.clipped, merged.dark));
}

}  // namespace hdr::tools
