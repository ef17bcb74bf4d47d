#include <fmt/format.h>

#include <filesystem>
#include <set>

#include "libhdr/align/warp.h"
#include "libhdr/core/error.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/shots_output.h"

namespace hdr::tools {
namespace {

void write_registered(const Path& folder, const Bracket& bracket, const Alignment& alignment,
                      const Response& response) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw Error(folder.string() + ": cannot be made: " + failed.message());
  std::set<Path> names;
  for (const Photo& shot : bracket.shots) {
    const Path name = Path(shot.path.filename()).replace_extension(".png");
    const bool taken = !names.insert(name).second;
    if (taken || std::filesystem::exists(folder / shot.path.filename(), failed)) {
      throw Error(fmt::format("{}: would overwrite {}; choose another folder for the registered shots", folder.string(),
                              taken ? "one registered shot by another" : "a photograph"));
    }
  }
  for (std::size_t k = 0; k < bracket.shots.size(); ++k) {
    const Photo warped = warp(bracket.shots[k], alignment.frames[k].ref_from_photo, response);
    Path name = bracket.shots[k].path.filename();
    write_photo(folder / name.replace_extension(".png"), warped);
  }
}

}  // namespace

std::function<int(Run&)> declare_align(CLI::App& app) {
  struct Options {
    ShotsOptions shots;
    std::string method = "auto", output;
  };
  auto options = std::make_shared<Options>();
  options->shots.declare(app);
  app.add_option("-o,--output", options->output, "folder for the registered shots (PNG); without it only the numbers");
  app.add_option("--method", options->method, "auto, none, mtb, ecc or features")->capture_default_str();
  return [options](Run& run) {
    const AlignMethod method = align_method(options->method);
    const Bracket bracket = read_shots(run, options->shots);
    const std::optional<std::string> noted = response_of_folder(expand_shots(options->shots.files));
    const std::optional<Response> known = noted ? known_response(*noted, bracket.bits()) : std::nullopt;
    const Alignment alignment = align_shots(run, bracket, known, method);
    answer_alignment(run, bracket, alignment);
    if (!options->output.empty()) {
      run.stage("write", [&] {
        write_registered(options->output, bracket, alignment, known ? *known : provisional_response(bracket));
      });
    }
    return 0;
  };
}

}  // namespace hdr::tools
