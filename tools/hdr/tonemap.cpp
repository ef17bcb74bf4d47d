#include "libhdr/filter/tonemap.h"

#include <fmt/format.h>

#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

std::function<int(Run&)> declare_tonemap(CLI::App& app) {
  struct Options {
    std::string image, output;
    std::optional<double> stops;
    bool alpha = false;
  };
  auto options = std::make_shared<Options>();
  app.add_option("image", options->image, "a radiance map")->required();
  app.add_option("-o,--output", options->output, "the picture (.png, .jpg)")->required();
  app.add_option("--stops", options->stops, "exposure in stops (default: metered to 18 % grey)");
  app.add_flag("--alpha", options->alpha, "keep coverage as transparency (PNG); else backdrops are seen");
  return [options](Run& run) {
    const ReadMap source = run.stage("read", [&] { return read_map(options->image); });
    for (const std::string& warning : source.warnings) run.warn(warning);
    const double stops = options->stops ? *options->stops : metered_stops(source.map.rgb);
    const Image<std::uint8_t> picture = run.stage("tonemap", [&] {
      return tonemap(source.map.rgb, stops, options->alpha ? source.map.alpha.view() : View<const float>{});
    });
    run.stage("write", [&] { write_picture(options->output, picture); });
    run.answer["stops"] = stops;
    run.say(fmt::format("{:+.2f} stops\nwrote {}", stops, options->output));
    return 0;
  };
}

}  // namespace hdr::tools
