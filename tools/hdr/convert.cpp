#include "libhdr/core/error.h"
#include "tools/hdr/image_input.h"
#include "tools/hdr/options.h"
#include "tools/hdr/pipeline.h"

namespace hdr::tools {

std::function<int(Run&)> declare_convert(CLI::App& app) {
  struct Options {
    std::string in, out, mantissa = "plain", primaries = "rec709";
    bool grey = false;
    WriteFlags write;
  };
  auto options = std::make_shared<Options>();
  app.add_option("in", options->in, "a map, a picture or a raw photograph")->required();
  app.add_option("out", options->out, "a map (.exr, .hdr, .pfm, .tif) or a picture (.png, .jpg)")->required();
  app.add_option(
         "--mantissa", options->mantissa,
         "how Radiance files are decoded: plain m 2^(e-136), or middle (m + 1/2) 2^(e-136) as Radiance does, whose "
         "own files were cut and not rounded: 0.2 to 0.4 % more")
      ->check(CLI::IsMember({"plain", "middle"}))
      ->capture_default_str();
  app.add_option("--primaries", options->primaries, "rec709, or as-in-file: nothing is converted, and the file says so")
      ->check(CLI::IsMember({"rec709", "as-in-file"}))
      ->capture_default_str();
  app.add_flag("--grey", options->grey, "PFM: luminance alone (Pf)");
  options->write.declare(app);
  return [options](Run& run) {
    ReadMapOptions read;
    if (options->mantissa == "middle") read.mantissa = Mantissa::kMiddle;
    if (options->primaries == "as-in-file") read.primaries = Primaries::kAsInFile;
    const RadianceMap map = read_image(run, options->in, read);
    WriteOptions write = options->write.options();
    write.grey = options->grey;
    write_image(run, options->out, map, provenance_of(run, Path(options->in)), write);
    run.answer["width"] = map.rgb.width();
    run.answer["height"] = map.rgb.height();
    return 0;
  };
}

}  // namespace hdr::tools
