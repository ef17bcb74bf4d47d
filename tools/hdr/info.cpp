#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/error.h"
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

}  // namespace

std::function<int(Run&)> declare_info(CLI::App& app) {
  auto files = std::make_shared<std::vector<Path>>();
  app.add_option("files", *files, "photographs and maps")->required();
  return [files](Run& run) {
    int code = 0;
    Json rows = Json::array();
    for (const Path& file : *files) {
      try {
        const FileInfo info = run.clock.run(file.filename().string(), [&] { return read_info(file); });
        rows.push_back(row_of(info));
        run.say(line_of(info));
      } catch (const Error& error) {
        fmt::print(stderr, "hdr info: {}\n", error.what());
        code = 1;
      }
    }
    run.answer["files"] = std::move(rows);
    return code;
  };
}

}  // namespace hdr::tools
