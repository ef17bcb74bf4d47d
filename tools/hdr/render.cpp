#include "libhdr/render/render.h"

#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "libhdr/io/output_file.h"
#include "libhdr/render/obj.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/probe_input.h"
#include "tools/hdr/prt_file.h"

namespace hdr::tools {
namespace {

struct Options {
  ProbeInput probe;
  std::string output, scene, method = "auto", size = "640x480", eye, look, material = "diffuse:0.5";
  std::optional<double> fov;
  int samples = 64;
  std::uint64_t seed = 1;
  WriteFlags write;
};

// Looks at the mesh from a little above, all of it in the picture.
Camera camera_for(const Mesh& mesh) {
  Vec3f low = mesh.positions[0], high = low;
  for (const Vec3f& p : mesh.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Vec3f middle = 0.5f * (low + high);
  const float radius = std::max(1e-6f, 0.5f * (high - low).norm());
  return {middle + radius * Vec3f(0.6f, 0.9f, 3.4f), middle, 40};
}

Scene scene_of(const Options& options, std::vector<Transfer>& transfer) {
  Scene scene;
  const std::string extension = Path(options.scene).extension().string();
  if (options.scene.empty()) {
    scene = spheres_on_plane();
  } else if (options.scene == "sphere") {
    scene = sphere_alone(material_from_text(options.material));
  } else if (extension == ".obj" || extension == ".prt") {
    if (extension == ".prt") {
      PrtMesh prt = read_prt(options.scene);
      scene.meshes.push_back(std::move(prt.mesh));
      transfer.push_back(std::move(prt.transfer));
    } else {
      scene.meshes.push_back(with_smooth_normals(mesh_from_obj(read_text(options.scene), options.scene)));
    }
    scene.meshes[0].material = material_from_text(options.material);
    scene.camera = camera_for(scene.meshes[0]);
  } else {
    throw Error(options.scene +
                ": not a scene of this build; leave --scene out for spheres on a plane, or pass sphere, a mesh "
                "(.obj) or one with its transfer (.prt)");
  }
  if (!options.eye.empty()) scene.camera.eye = vec3_from_text(options.eye, "--eye").cast<float>();
  if (!options.look.empty()) scene.camera.look = vec3_from_text(options.look, "--look").cast<float>();
  if (options.fov) scene.camera.fov_degrees = *options.fov;
  if (!(scene.camera.fov_degrees > 0 && scene.camera.fov_degrees < 180))
    throw Error("--fov: give degrees between 0 and 180");
  if ((scene.camera.eye - scene.camera.look).norm() == 0)
    throw Error("--eye and --look are the same point; move one of them");
  return scene;
}

}  // namespace

std::function<int(Run&)> declare_render(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->probe.declare(app, false);
  app.add_option("-o,--output", options->output, "the picture (.exr, RGBA: alpha is coverage)")->required();
  app.add_option("--scene", options->scene,
                 "`sphere` is one sphere alone, a .obj mesh, or a .prt of `hdr prt` (default: spheres on a plane)");
  app.add_option("--method", options->method, "auto, mc, importance, structured, mis, ao, sh or prt")
      ->check(CLI::IsMember({"auto", "mc", "importance", "structured", "mis", "ao", "sh", "prt"}))
      ->capture_default_str();
  app.add_option("--samples", options->samples, "a pixel")->check(CLI::Range(1, 1 << 20))->capture_default_str();
  app.add_option("--size", options->size, "of the picture")->capture_default_str();
  app.add_option("--eye", options->eye, "the camera's place X,Y,Z, +Y up");
  app.add_option("--look", options->look, "the point it looks at");
  app.add_option("--fov", options->fov, "horizontal, degrees");
  app.add_option("--material", options->material, "of the sphere: diffuse:ALBEDO, ggx:ROUGHNESS, mirror")
      ->capture_default_str();
  app.add_option("--seed", options->seed, "of the random numbers")->capture_default_str();
  options->write.declare(app);
  return [options](Run& run) {
    const RenderMethod method = render_method_from_name(options->method).value();
    RenderOptions settings{method, size_from_text(options->size, "--size"), options->samples, options->seed, {}, {}};
    const Scene scene = run.stage("scene", [&] { return scene_of(*options, settings.transfer); });
    const Probe probe = options->probe.read(run);
    // Both samplers together reach every direction: the probe's may leave the dim ones to the surface's [Karlik19].
    const bool both = method == RenderMethod::kMis || method == RenderMethod::kAuto;
    const auto density = both ? Environment::Density::kCompensated : Environment::Density::kLuminance;
    const Environment light =
        run.stage("tables", [&] { return Environment::from_probe(probe.map, probe.projection, 0, density); });
    const Rendering result = run.stage("render", [&](const Progress& progress) {
      settings.progress = [&progress](double done) { progress.update(done); };
      return render(scene, light, settings);
    });
    if (!result.skipped.empty()) run.clock.skipped(result.skipped);
    const Stage& stage = run.clock.stages().back();
    run.answer["seconds"] = stage.seconds;
    run.answer["cpu_seconds"] = stage.cpu_seconds;
    run.answer["method"] = name_of(result.method);
    run.answer["rays"] = result.rays;
    run.answer["samples_per_pixel"] = result.samples_per_pixel;
    run.answer["estimated_error"] = result.estimated_error;
    run.say(fmt::format("{}: {} samples a pixel, {:.1f} M rays, estimated error {:.2g}", name_of(result.method),
                        result.samples_per_pixel, static_cast<double>(result.rays) / 1e6, result.estimated_error));
    run.stage("write", [&] {
      write_map(options->output, result.picture, provenance_of(run, options->probe.path), options->write.options());
    });
    run.say("wrote " + options->output);
    return 0;
  };
}

}  // namespace hdr::tools
