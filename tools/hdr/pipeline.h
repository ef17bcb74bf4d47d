#pragma once
// The order of the main job: read -> provisional response -> align linearised shots -> final fit on registered pixels
// -> merge. Verbs run as much of it as they need; each step reports its stage and its keys of the answer.
#include <optional>

#include "libhdr/align/align.h"
#include "libhdr/merge/merge.h"
#include "libhdr/response/calibrate.h"
#include "tools/hdr/options.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

/// Options of merge and probe alike.
struct MergePipelineOptions {
  ShotsOptions shots;
  CalibrateFlags calibrate;
  MergeFlags merge;
  ScaleFlags scale;
  std::string align = "auto";
  std::optional<Response> given_response;  ///< of another bracket of the same camera: then nothing is fitted
  std::optional<double> given_unit;        ///< likewise MergeOptions::exposure_unit

  void declare(CLI::App& app);
};

/// A bracket that is ready to be merged.
struct MergeInputs {
  Bracket bracket;
  Response response;
  std::optional<Calibration> fit;  ///< nothing when the response was given; its response is the one above
  Alignment alignment;
  MergeOptions options;  ///< with its exposure unit
  Image<float> flat;     ///< what options.flat views
  ScaleFlags scale;
  std::string ghost_mask;                 ///< where to write it; empty: nowhere
  std::optional<double> white_luminance;  ///< cd/m^2 of radiance 1, as far as it is known before the merge
};

/// Reads the shots. Their codes stay in memory while they fit in what a merge may use: 2.5 times its map.
Bracket read_shots(Run& run, const ShotsOptions& options);

/// Response from --response, or nothing when it is to be fitted.
std::optional<Response> known_response(const std::string& text, int bits);

Alignment align_shots(Run& run, const Bracket& bracket, const std::optional<Response>& known, AlignMethod method);

Calibration calibrate_shots(Run& run, const Bracket& bracket, const Alignment& alignment, const CalibrateFlags& flags);

/// Reads, aligns and calibrates.
MergeInputs prepare_merge(Run& run, const MergePipelineOptions& options);
/// The map in memory. `digest`, which may be none, gets all rows with their deviations and flags, whatever was asked
/// for.
Merged merge_shots(Run& run, const MergeInputs& inputs, MapSink* digest = nullptr);
/// The map on the disk, written as its rows come: `merged.map` is empty.
Merged merge_to_file(Run& run, const MergeInputs& inputs, const Path& output, const WriteOptions& options,
                     MapSink* digest = nullptr);

/// Version, options, shots with their exposures (names without folders).
Provenance provenance_of(const Run& run, const MergeInputs& inputs);
/// The same for the merged map itself, which is seen as its camera saw it: with that camera's field, where EXIF tells.
Provenance provenance_of_map(const Run& run, const MergeInputs& inputs);
Provenance provenance_of(const Run& run, const Path& input);

/// Rows of the answer, in the order in which the user named the files.
void answer_calibration(Run& run, const Bracket& bracket, const Calibration& calibration);
void answer_alignment(Run& run, const Bracket& bracket, const Alignment& alignment);
void answer_merge(Run& run, const MergeInputs& inputs, const Merged& merged);

}  // namespace hdr::tools
