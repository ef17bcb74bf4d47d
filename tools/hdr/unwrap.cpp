#include "libhdr/core/error.h"
#include "libhdr/io/read.h"
#include "tools/hdr/cube_files.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/unwrap_step.h"

namespace hdr::tools {

std::function<int(Run&)> declare_unwrap(CLI::App& app) {
  struct Options {
    std::vector<std::string> images;
    std::string output;
    UnwrapFlags unwrap;
    WriteFlags write;
  };
  auto options = std::make_shared<Options>();
  app.add_option(
         "image", options->images,
         "a radiance map (or an sRGB photograph); a cube's six faces, named ..._px, _nx, _py, _ny, _pz, _nz or in "
         "the order +X -X +Y -Y +Z -Z")
      ->required();
  app.add_option("-o,--output", options->output, "the picture to write (.exr, .hdr, .tif)")->required();
  options->unwrap.declare(app);
  options->write.declare(app);
  return [options](Run& run) {
    const bool faces = are_cube_faces(options->images);
    if (options->images.size() != 1 && !faces) {
      throw CLI::ValidationError("image", "give one picture, or the six faces of a cube");
    }
    const std::string& name = options->images[0];
    const ReadMap source = run.stage("read", [&] { return faces ? read_cube_faces(options->images) : read_map(name); });
    for (const std::string& warning : source.warnings) run.warn(warning);
    const RadianceMap probe = unwrap_picture(run, source.map, options->unwrap, "", name);
    const Provenance provenance = provenance_of(run, Path(name));
    const bool six_files = probe.projection.starts_with("cube-faces");
    run.stage("write", [&] {
      if (six_files) return write_cube_faces(options->output, probe, provenance, options->write.options());
      write_map(options->output, probe, provenance, options->write.options());
    });
    run.say("wrote " + (six_files ? cube_face_paths(options->output)[0].string() + " ... _nz" : options->output));
    return 0;
  };
}

}  // namespace hdr::tools
