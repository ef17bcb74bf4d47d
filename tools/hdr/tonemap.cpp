#include "libhdr/filter/tonemap.h"

#include <fmt/format.h>

#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

std::function<int(Run&)> declare_tonemap(CLI::App& app) {
  struct Options {
    std::string image, output, tone = "reinhard";
    std::optional<double> stops;
    bool alpha = false;
  };
  auto options = std::make_shared<Options>();
  app.add_option("image", options->image, "a radiance map")->required();
  app.add_option("-o,--output", options->output, "the picture (.png, .jpg)")->required();
  app.add_option("--stops", options->stops, "exposure in stops (default: metered to 18 % grey)");
  app.add_option(
         "--operator", options->tone,
         "reinhard: a shoulder; filmic: a film's; local: compresses large differences, keeps details; clip: none; "
         "false-colour: a colour a stop, with a legend")
      ->check(CLI::IsMember({"reinhard", "filmic", "local", "bilateral", "clip", "false-colour", "false-color"}))
      ->capture_default_str();
  app.add_flag("--alpha", options->alpha, "keep coverage as transparency (PNG); else backdrops are seen");
  return [options](Run& run) {
    const ReadMap source = run.stage("read", [&] { return read_map(options->image); });
    for (const std::string& warning : source.warnings) run.warn(warning);
    const double stops = options->stops ? *options->stops : metered_stops(source.map.rgb);
    const bool as_colours = options->tone.starts_with("false-");
    const Image<std::uint8_t> picture = run.stage("tonemap", [&] {
      if (!as_colours) {
        return tonemap(source.map.rgb, stops, options->alpha ? source.map.alpha.view() : View<const float>{},
                       tone_operator_from_name(options->tone).value());
      }
      FalseColour colours = false_colour(source.map.rgb, stops);
      run.answer["legend"] = {{"lowest", colours.lowest}, {"highest", colours.highest}};
      run.say(fmt::format("colours: {:+d} to {:+d} stops from 18 % grey, one a stop", colours.lowest, colours.highest));
      return std::move(colours.picture);
    });
    run.stage("write", [&] { write_picture(options->output, picture); });
    run.answer["stops"] = stops;
    run.say(fmt::format("{:+.2f} stops\nwrote {}", stops, options->output));
    return 0;
  };
}

}  // namespace hdr::tools
