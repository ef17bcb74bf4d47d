#include "libhdr/filter/fuse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/align/warp.h"
#include "libhdr/core/error.h"
#include "libhdr/core/rows.h"
#include "libhdr/io/read.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/shots_output.h"

namespace hdr::tools {
namespace {

struct Options {
  ShotsOptions shots;
  std::string output, align = "auto";
  FuseOptions weights;
};

Image<std::uint8_t> codes_of(const Image<float>& fused) {
  Image<std::uint8_t> codes(fused.size(), 3);
  for (int y = 0; y < fused.height(); ++y) {
    std::transform(fused.row(y), fused.row(y) + fused.row_samples(), codes.row(y),
                   [](float v) { return static_cast<std::uint8_t>(std::lround(255 * v)); });
  }
  return codes;
}

/// Registered, where the shots say how they were exposed.
Image<float> fuse_bracket(Run& run, const Options& options, AlignMethod method) {
  const Bracket bracket = read_shots(run, options.shots);
  const std::optional<std::string> noted = response_of_folder(expand_shots(options.shots.files));
  const std::optional<Response> known = noted ? known_response(*noted, bracket.bits()) : std::nullopt;
  const Alignment alignment = align_shots(run, bracket, known, method);
  answer_alignment(run, bracket, alignment);
  const bool moves = !alignment.identity();
  const std::optional<Response> response = !moves  ? std::nullopt
                                           : known ? known
                                                   : std::optional(provisional_response(bracket));
  const auto shot = [&](int k) {
    const auto index = static_cast<std::size_t>(k);
    const LoadedShot loaded(bracket.shots[index]);
    const Mat3 matrix = moves ? alignment.frames[index].ref_from_photo : Mat3::Identity();
    if (moves && !matrix.isIdentity()) return warp(*loaded, matrix, *response);
    Photo copy{loaded->path, loaded->exposure, loaded->bits, loaded->lossy, {}, {}};
    std::visit([&](const auto& codes) { copy.codes = codes.clone(); }, loaded->codes);
    return copy;
  };
  return run.stage("fuse", [&] { return fuse(static_cast<int>(bracket.shots.size()), shot, options.weights); });
}

/// As they lie: fusion needs no exposures.
Image<float> fuse_as_they_lie(Run& run, const Options& options, const std::vector<Path>& paths) {
  const auto shot = [&](int k) { return read_photo(paths[static_cast<std::size_t>(k)]); };
  return run.stage("fuse", [&] { return fuse(static_cast<int>(paths.size()), shot, options.weights); });
}

}  // namespace

std::function<int(Run&)> declare_fuse(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->shots.declare(app);
  app.add_option("-o,--output", options->output, "the picture (.png, .jpg)")->required();
  app.add_option("--align", options->align, "auto, none, mtb, ecc or features")->capture_default_str();
  app.add_option("--contrast", options->weights.contrast, "exponent of contrast in the weights")->capture_default_str();
  app.add_option("--saturation", options->weights.saturation, "exponent of saturation")->capture_default_str();
  app.add_option("--exposedness", options->weights.exposedness, "exponent of being well exposed")
      ->capture_default_str();
  return [options](Run& run) {
    const AlignMethod method = align_method(options->align);
    for (const double exponent :
         {options->weights.contrast, options->weights.saturation, options->weights.exposedness}) {
      if (!(exponent >= 0 && exponent <= 100)) throw CLI::ValidationError("exponents", "give numbers from 0 to 100");
    }
    const std::vector<Path> paths = expand_shots(options->shots.files);
    const bool given = !options->shots.times.empty() || !options->shots.exposures.empty();
    const bool timed = std::all_of(paths.begin(), paths.end(), [](const Path& path) {
      return read_photo_header(path).exposure.seconds.has_value();
    });
    if (!given && !timed && method != AlignMethod::kNone) {
      run.warn(
          "no exposure times in EXIF: the shots are fused as they lie, not registered; pass --times to register them");
    }
    const bool as_bracket = (given || timed) && paths.size() > 1 && method != AlignMethod::kNone;
    const Image<float> fused =
        as_bracket ? fuse_bracket(run, *options, method) : fuse_as_they_lie(run, *options, paths);
    run.stage("write", [&] { write_picture(options->output, codes_of(fused)); });
    run.answer["width"] = fused.width();
    run.answer["height"] = fused.height();
    run.say("wrote " + options->output);
    return 0;
  };
}

}  // namespace hdr::tools
