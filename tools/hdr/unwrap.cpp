#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "libhdr/io/read.h"
#include "tools/hdr/ball_views_step.h"
#include "tools/hdr/cube_files.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/unwrap_pair.h"
#include "tools/hdr/unwrap_step.h"

namespace hdr::tools {
namespace {

struct Options {
  std::vector<std::string> images, masks;
  std::string output;
  UnwrapFlags unwrap;
  WriteFlags write;
};

/// Several pictures are views of one ball when --from says so, or the first one's tag does.
bool are_ball_views(const Options& o) {
  if (o.images.size() < 2) return false;
  if (!o.unwrap.from.empty()) return o.unwrap.from.starts_with(MirrorBall::kName);
  const std::string tag = read_map(o.images[0]).map.projection;
  return (tag.empty() ? o.unwrap.implied_from : tag).starts_with(MirrorBall::kName);
}

/// Options that are of one picture.
void require_one_picture(const Options& o) {
  const UnwrapFlags& u = o.unwrap;
  if (!u.level && u.horizon.empty() && u.crop.empty()) return;
  throw Error(fmt::format("{} is for one picture; join them first, and then level or crop what was written",
                          u.level          ? "--level"
                          : u.crop.empty() ? "--horizon"
                                           : "--crop"));
}

RadianceMap unwrap_images(Run& run, const Options& o, bool ball_views) {
  if (o.images.size() > 1) require_one_picture(o);
  if (ball_views) return unwrap_ball_views(run, o.images, o.masks, o.unwrap);
  if (!o.masks.empty()) throw Error("--mask: is for several views of one ball");
  const bool faces = are_cube_faces(o.images);
  if (o.images.size() > 2 && !faces) {
    throw CLI::ValidationError(
        "image",
        "give one picture, several views of one ball (--from mirror-ball), two opposite fisheyes "
        "(--from fisheye), or the six faces of a cube");
  }
  const auto read = [&](const std::string& name) {
    ReadMap picture = run.stage("read", [&] { return faces ? read_cube_faces(o.images) : read_map(name); });
    for (const std::string& warning : picture.warnings) run.warn(warning);
    o.unwrap.correct_vignetting(picture.map);
    return picture;
  };
  const ReadMap source = read(o.images[0]);
  if (faces || o.images.size() == 1) return unwrap_picture(run, source.map, o.unwrap, "", o.images[0]);
  const ReadMap second = read(o.images[1]);
  if (!are_fisheye_pair({&source.map, &second.map}, o.unwrap)) {
    throw CLI::ValidationError("image",
                               "two pictures make a sphere when they are fisheyes or views of one ball; add "
                               "--from fisheye or --from mirror-ball");
  }
  return unwrap_fisheye_pair(run, source.map, second.map, o.unwrap, o.images);
}

Provenance provenance_of_images(const Run& run, const Options& o, bool ball_views) {
  if (!ball_views) return provenance_of(run, Path(o.images[0]));
  Provenance provenance = provenance_of(run, Path{});
  std::string names;
  for (const std::string& image : o.images) names += (names.empty() ? "" : " ") + Path(image).filename().string();
  provenance.add("input", names);
  return provenance;
}

}  // namespace

std::function<int(Run&)> declare_unwrap(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("image", options->images,
                 "a radiance map (or an sRGB photograph); several views of one mirror ball; two opposite fisheyes; a "
                 "cube's six faces, named "
                 "..._px, _nx, _py, _ny, _pz, _nz or in the order +X -X +Y -Y +Z -Z")
      ->required();
  app.add_option("-o,--output", options->output, "the picture to write (.exr, .hdr, .tif)")->required();
  app.add_option("--mask", options->masks,
                 "with several views: a picture for each, white where it is to be used; - for all of it");
  options->unwrap.declare(app);
  options->unwrap.declare_seam(app);
  options->write.declare(app);
  return [options](Run& run) {
    const bool ball_views = are_ball_views(*options);
    const RadianceMap probe = unwrap_images(run, *options, ball_views);
    const Provenance provenance = provenance_of_images(run, *options, ball_views);
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
