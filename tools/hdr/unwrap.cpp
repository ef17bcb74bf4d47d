#include "libhdr/io/read.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/unwrap_step.h"

namespace hdr::tools {

std::function<int(Run&)> declare_unwrap(CLI::App& app) {
  struct Options {
    std::string image, output;
    UnwrapFlags unwrap;
    WriteFlags write;
  };
  auto options = std::make_shared<Options>();
  app.add_option("image", options->image, "a radiance map (or an sRGB photograph)")->required();
  app.add_option("-o,--output", options->output, "the picture to write (.exr, .hdr, .tif)")->required();
  options->unwrap.declare(app);
  options->write.declare(app);
  return [options](Run& run) {
    const ReadMap source = run.stage("read", [&] { return read_map(options->image); });
    for (const std::string& warning : source.warnings) run.warn(warning);
    const RadianceMap probe = unwrap_picture(run, source.map, options->unwrap, "", options->image);
    run.stage("write", [&] {
      write_map(options->output, probe, provenance_of(run, Path(options->image)), options->write.options());
    });
    run.say("wrote " + options->output);
    return 0;
  };
}

}  // namespace hdr::tools
