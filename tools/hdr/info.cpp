#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/io/bracket.h"
#include "libhdr/io/bracket_report.h"
#include "libhdr/io/read.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {
namespace {

Json optional_number(const std::optional<double>& number) {
  return number ? Json(*number) : Json(nullptr);
}

Json row_of(const FileInfo& info) {
  return {{"path", info.path.string()},
          {"format", info.format},
          {"width", info.width},
          {"height", info.height},
          {"channels", info.channels},
          {"type", info.type},
          {"compression", info.compression},
          {"exposure",
           {{"seconds", optional_number(info.exposure.seconds)},
            {"f_number", optional_number(info.exposure.f_number)},
            {"iso", optional_number(info.exposure.iso)}}},
          {"white_luminance", optional_number(info.white_luminance)},
          {"min", info.min},
          {"max", info.max},
          {"mean", info.mean},
          {"nan", info.nan},
          {"inf", info.inf},
          {"negative", info.negative},
          {"stops", info.stops},
          {"projection", info.projection}};
}

std::string line_of(const FileInfo& info) {
  std::string line = fmt::format("{}: {} {}x{}, {} channels of {}", info.path.string(), info.format, info.width,
                                 info.height, info.channels, info.type);
  if (!info.compression.empty()) line += ", " + info.compression;
  if (info.exposure.seconds) {
    const double t = *info.exposure.seconds;
    line += t < 0.4 ? fmt::format(", 1/{:.4g} s", 1 / t) : fmt::format(", {:.4g} s", t);
  }
  if (info.exposure.f_number) line += fmt::format(", f/{:.3g}", *info.exposure.f_number);
  if (info.exposure.iso) line += fmt::format(", ISO {:.0f}", *info.exposure.iso);
  line += fmt::format(", {:.4g} .. {:.4g}, mean {:.4g}, {:.1f} stops", info.min, info.max, info.mean, info.stops);
  if (info.nan + info.inf + info.negative > 0) {
    line += fmt::format(", {} NaN, {} infinite, {} negative", info.nan, info.inf, info.negative);
  }
  if (info.white_luminance) line += fmt::format(", white {:.4g} cd/m^2", *info.white_luminance);
  if (!info.projection.empty()) line += ", " + info.projection;
  return line;
}

/// Files as named; a folder stands for its photographs.
std::vector<Path> files_in(const std::vector<Path>& named) {
  std::vector<Path> files;
  for (const Path& path : named) {
    std::error_code failed;
    if (!std::filesystem::is_directory(path, failed)) {
      files.push_back(path);
      continue;
    }
    const std::vector<Path> inside = expand_shots({path});
    files.insert(files.end(), inside.begin(), inside.end());
  }
  return files;
}

Json row_of(const ShotReport& shot) {
  return {{"path", shot.path.string()},
          {"ev", shot.ev},
          {"step", optional_number(shot.step)},
          {"seconds", optional_number(shot.exposure.seconds)},
          {"clipped", shot.clipped},
          {"dark", shot.dark}};
}

void say_bracket(Run& run, const BracketReport& report) {
  run.say(fmt::format("\nAs a bracket: {} shots over {:.2f} EV", report.shots.size(), report.span_ev));
  for (const ShotReport& shot : report.shots) {
    const std::string step = shot.step ? fmt::format("step {:4.2f}", *shot.step) : "         ";
    run.say(fmt::format("  {:+6.2f} EV  {}  clipped {:5.1f} %  dark {:5.1f} %  {}", shot.ev, step, 100 * shot.clipped,
                        100 * shot.dark, shot.path.filename().string()));
  }
  if (report.nominal_times) {
    run.say("  times as on the dial (1/60 for 1/64 s): the shutter's may be 6 % off; --refine-times fits them");
  }
  for (const std::string& sentence : report.missing) run.say("  missing: " + sentence);
  if (report.missing.empty()) run.say("  covers the scene: neither shadows nor highlights are lost");
}

/// What the photographs among the files would be as one bracket, or why they would be none.
void add_bracket(Run& run, const std::vector<Path>& shots) {
  Json& answer = run.answer["bracket"];
  try {
    BracketOptions options;
    options.code_bytes_a_pixel = 0;  // one shot in memory at a time
    const Bracket bracket = run.clock.run("bracket", [&] { return read_bracket(shots, options); });
    for (const std::string& warning : bracket.warnings) run.warn(warning);
    const BracketReport report = report_bracket(bracket);
    answer = {{"span_ev", report.span_ev}, {"nominal_times", report.nominal_times}, {"missing", report.missing}};
    answer["shots"] = Json::array();
    for (const ShotReport& shot : report.shots) answer["shots"].push_back(row_of(shot));
    say_bracket(run, report);
  } catch (const Error& error) {
    answer = {{"refused", error.what()}};
    run.say(std::string("\nNo bracket: ") + error.what());
  }
}

}  // namespace

std::function<int(Run&)> declare_info(CLI::App& app) {
  auto files = std::make_shared<std::vector<Path>>();
  app.add_option("files", *files,
                 "photographs and maps, or a folder of photographs; several photographs are also judged as "
                 "a bracket: steps, clipped and dark shares, what is missing")
      ->required();
  return [files](Run& run) {
    int code = 0;
    Json rows = Json::array();
    std::vector<Path> shots;
    for (const Path& file : files_in(*files)) {
      try {
        const FileInfo info = run.clock.run(file.filename().string(), [&] { return read_info(file); });
        rows.push_back(row_of(info));
        run.say(line_of(info));
        if (info.exposure.seconds && is_photo_name(file)) shots.push_back(file);
      } catch (const Error& error) {
        fmt::print(stderr, "hdr info: {}\n", error.what());
        code = 1;
      }
    }
    if (shots.size() > 1) add_bracket(run, shots);
    run.answer["files"] = std::move(rows);
    return code;
  };
}

}  // namespace hdr::tools
