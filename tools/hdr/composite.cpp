#include "libhdr/render/composite.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/render/bounds.h"
#include "libhdr/render/plane_pose.h"
#include "tools/hdr/backplate.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/probe_input.h"
#include "tools/hdr/scene_input.h"

namespace hdr::tools {
namespace {

struct Options {
  ProbeInput probe;
  CameraFlags camera;
  MeshFlags mesh;
  std::string background, objects, ground = "plane", output, cut_out, response, material, method = "auto";
  std::string corners, rectangle, place;
  double turn = 0, scale = 1;
  std::optional<double> gain, albedo;
  int width = 0, samples = 64;
  std::uint64_t seed = 1;
  WriteFlags write;
};

void declare_options(CLI::App& app, Options& options) {
  app.add_option("--background", options.background, "a photograph, or a radiance map of its view")->required();
  options.probe.declare(app, false);
  app.add_option("--objects", options.objects, "what is put into it: a mesh (.obj .ply .gltf .glb), or `sphere`")
      ->required();
  app.add_option("--ground", options.ground, "what it stands on: `plane` (y = 0) or a mesh")->capture_default_str();
  app.add_option("-o,--output", options.output, "the picture (.exr .hdr, or .png .jpg)")->required();
  app.add_option("--cut-out", options.cut_out, "objects and shadows alone, RGBA (.exr)");
  options.camera.declare(app);
  app.add_option("--corners", options.corners,
                 "the camera from a rectangle on the ground around 0,0,0: X,Y in the picture of its near left, near "
                 "right, far right and far left corners");
  app.add_option("--rectangle", options.rectangle, "its size in the scene's units: WIDTHxDEPTH");
  app.add_option("--place", options.place, "X,Y,Z where the middle of the objects' base stands");
  app.add_option("--turn", options.turn, "degrees about +Y")->capture_default_str();
  app.add_option("--scale", options.scale, "of the objects")->check(CLI::PositiveNumber)->capture_default_str();
  options.mesh.declare(app);
  app.add_option("--material", options.material, "in place of the objects' own");
  app.add_option("--response", options.response,
                 "the photograph's: a file of `hdr calibrate`, linear, gamma:2.2 (default: sRGB)");
  auto* gain =
      app.add_option("--gain", options.gain, "what the photograph shows of the probe's radiance 1 (default: 1)")
          ->check(CLI::PositiveNumber);
  app.add_option("--ground-albedo", options.albedo, "the ground's, in green: --gain follows from it")
      ->check(CLI::Range(1e-6, 1.0))
      ->excludes(gain);
  app.add_option("--width", options.width, "of the result (default: the photograph's)")->check(CLI::Range(1, 65536));
  app.add_option("--method", options.method, "as in `hdr render`")->capture_default_str();
  app.add_option("--samples", options.samples, "a pixel")->check(CLI::Range(1, 1 << 20))->capture_default_str();
  app.add_option("--seed", options.seed, "of the random numbers")->capture_default_str();
  options.write.declare(app);
}

// "x,y,x,y,x,y,x,y" and "2x3".
PhotographedRectangle rectangle_of(const Options& options) {
  const std::vector<double> numbers = times_from_text(options.corners, "--corners");
  if (numbers.size() != 8) throw Error("--corners: give eight numbers, X,Y of four corners in pixels");
  std::string sides = options.rectangle;
  std::replace(sides.begin(), sides.end(), 'x', ',');
  const std::vector<double> size = times_from_text(sides, "--rectangle");
  if (size.size() != 2) throw Error("--rectangle: give WIDTHxDEPTH, as 1.2x0.8");
  PhotographedRectangle rectangle;
  for (std::size_t k = 0; k < 4; ++k) rectangle.corners[k] = {numbers[2 * k], numbers[2 * k + 1]};
  rectangle.width = size[0];
  rectangle.depth = size[1];
  return rectangle;
}

struct Loaded {
  Scene scene;
  std::optional<double> vertical_fov;
};

Loaded load_objects(Run& run, const Options& options) {
  Loaded loaded;
  if (options.objects == "sphere") {
    loaded.scene = sphere_alone(material_from_text(options.material.empty() ? "diffuse:0.5" : options.material));
    for (Vec3f& p : loaded.scene.meshes[0].positions) p.y() += 1;
  } else {
    SceneFile file = read_meshes(run, options.objects, options.mesh);
    loaded.scene = std::move(file.scene);
    loaded.vertical_fov = file.vertical_fov_degrees;
    if (!options.material.empty())
      for (Mesh& mesh : loaded.scene.meshes) mesh.material = material_from_text(options.material);
  }
  return loaded;
}

// Scaled and turned about the middle of their base, which then moves to --place.
void put_in_place(Scene& scene, const Options& options) {
  if (options.place.empty() && options.turn == 0 && options.scale == 1) return;
  const auto [low, high] = bounds_of(scene);
  const Vec3f base(0.5f * (low.x() + high.x()), low.y(), 0.5f * (low.z() + high.z()));
  const Vec3f to = options.place.empty() ? base : Vec3f(vec3_from_text(options.place, "--place").cast<float>());
  const Eigen::Matrix3f turn = rotation_from_degrees({0, options.turn, 0}).cast<float>();
  for (Mesh& mesh : scene.meshes) {
    for (Vec3f& p : mesh.positions) p = Vec3f(to + turn * (static_cast<float>(options.scale) * (p - base)));
    for (Vec3f& n : mesh.normals) n = Vec3f(turn * n);
  }
}

Camera camera_of(Run& run, const Options& options, const Loaded& loaded, Size picture) {
  Camera camera = loaded.scene.camera;
  const double aspect = static_cast<double>(picture.width) / picture.height;
  if (!options.corners.empty()) {
    if (options.rectangle.empty()) throw Error("--corners: give the rectangle's size too, --rectangle WIDTHxDEPTH");
    const PlanePose pose = pose_from_rectangle(rectangle_of(options), picture, options.camera.fov);
    run.answer["camera"] = {{"eye", {pose.camera.eye.x(), pose.camera.eye.y(), pose.camera.eye.z()}},
                            {"look", {pose.camera.look.x(), pose.camera.look.y(), pose.camera.look.z()}},
                            {"fov", pose.camera.fov_degrees},
                            {"residual_px", pose.residual_px}};
    run.say(fmt::format("camera at {:.3f}, {:.3f}, {:.3f}, field of {:.1f} degrees; corners met within {:.2f} px",
                        pose.camera.eye.x(), pose.camera.eye.y(), pose.camera.eye.z(), pose.camera.fov_degrees,
                        pose.residual_px));
    constexpr double kFarOff = 0.01;  // of the picture's width
    if (pose.residual_px > kFarOff * picture.width)
      run.warn(
          fmt::format("--corners: no camera sees this rectangle so, the nearest is {:.1f} px off; check the "
                      "corners, --rectangle and --fov",
                      pose.residual_px));
    return pose.camera;
  }
  if (loaded.vertical_fov) {
    camera.fov_degrees = 2 * std::atan(aspect * std::tan(0.5 * *loaded.vertical_fov * kDegree)) / kDegree;
  } else if (options.camera.eye.empty() || options.camera.look.empty() || !options.camera.fov) {
    throw Error(
        "no camera: give --eye, --look and --fov, or --corners and --rectangle, or objects in a glTF file with one");
  }
  options.camera.apply_to(camera);
  return camera;
}

void add_ground(Run& run, const Options& options, Scene& scene, const Material& material) {
  if (options.ground == "plane") {
    // As far as a hundred times the camera's distance: to the horizon, for a photograph.
    const float reach = 100 * std::max(1.0f, scene.camera.eye.norm());
    scene.meshes.push_back(plane_mesh(reach, 0, material));
    return;
  }
  for (Mesh& mesh : read_meshes(run, options.ground, options.mesh).scene.meshes) {
    mesh.material = material;
    scene.meshes.push_back(std::move(mesh));
  }
}

// A quick render of the ground alone gives its albedo, or with a known one the photograph's unit.
double measure_ground(Run& run, const Options& options, Scene& scene, const Environment& light, const Backplate& plate,
                      RenderOptions settings) {
  settings.samples = std::min(settings.samples, 16);
  Scene ground;
  ground.camera = scene.camera;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.material.shadow_catcher) ground.meshes.push_back(mesh);
  const Rgbf rendered = ground.meshes.at(0).material.color;
  const Rendering alone = render(ground, light, settings);
  const std::optional<Rgbf> found = ground_albedo(plate.light(), alone.ground, rendered);
  if (!found) {
    run.warn("the photograph shows no ground that the probe lights: nothing for shadows to fall on");
    if (options.albedo) throw Error("--ground-albedo: the photograph shows no ground to compare with; pass --gain");
    return options.gain.value_or(1);
  }
  const double gain = options.albedo ? (*found)[1] / *options.albedo : options.gain.value_or(1);
  const Rgbf albedo = *found / static_cast<float>(gain);
  run.answer["ground_albedo"] = {albedo[0], albedo[1], albedo[2]};
  run.answer["gain"] = gain;
  run.say(fmt::format("ground: albedo {:.3f} {:.3f} {:.3f}; gain {:.3g}", albedo[0], albedo[1], albedo[2], gain));
  if (albedo.maxCoeff() > 1) {
    run.warn(
        fmt::format("the ground would reflect {:.2g} times the light that it gets: photograph and probe have "
                    "different units; pass --ground-albedo or --gain",
                    albedo.maxCoeff()));
  }
  for (Mesh& mesh : scene.meshes)
    if (mesh.material.shadow_catcher) mesh.material.color = albedo.max(0.0f).min(0.99f);
  return gain;
}

int composite(Run& run, const Options& options) {
  const std::optional<RenderMethod> method = render_method_from_name(options.method);
  if (!method) throw CLI::ValidationError("--method", options.method + " is not one of `hdr render --help`");
  const Backplate plate =
      run.stage("background", [&] { return Backplate(run, options.background, options.response, options.width); });
  Scene scene = run.stage("scene", [&] {
    Loaded loaded = load_objects(run, options);
    loaded.scene.camera = camera_of(run, options, loaded, plate.size());
    put_in_place(loaded.scene, options);
    Material ground;
    ground.shadow_catcher = true;
    add_ground(run, options, loaded.scene, ground);
    return std::move(loaded.scene);
  });
  const Probe probe = options.probe.read(run);
  const bool both = *method == RenderMethod::kMis || *method == RenderMethod::kAuto;
  const auto density = both ? Environment::Density::kCompensated : Environment::Density::kLuminance;
  const Environment light =
      run.stage("tables", [&] { return Environment::from_probe(probe.map, probe.projection, 0, density); });
  RenderOptions settings;
  settings.method = *method;
  settings.size = plate.size();
  settings.samples = options.samples;
  settings.seed = options.seed;
  const double gain = run.stage("ground", [&] { return measure_ground(run, options, scene, light, plate, settings); });
  const Differential differential = run.stage("render", [&](const Progress& progress) {
    settings.progress = [&progress](double done) { progress.update(done); };
    return render_differential(scene, light, settings);
  });
  const Stage& stage = run.clock.stages().back();
  run.answer["seconds"] = stage.seconds;
  run.answer["cpu_seconds"] = stage.cpu_seconds;
  run.answer["method"] = name_of(differential.with.method);
  run.answer["rays"] = differential.with.rays;
  const Provenance provenance = provenance_of(run, options.background);
  plate.write(run, options.output, composited(plate.light(), differential, gain), provenance, options.write.options());
  if (!options.cut_out.empty()) {
    write_map(options.cut_out, cut_out(differential), provenance, options.write.options());
    run.say("wrote " + options.cut_out);
  }
  return 0;
}

}  // namespace

std::function<int(Run&)> declare_composite(CLI::App& app) {
  auto options = std::make_shared<Options>();
  declare_options(app, *options);
  return [options](Run& run) { return composite(run, *options); };
}

}  // namespace hdr::tools
