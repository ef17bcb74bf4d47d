#include "tools/hdr/scene_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/colour_chart.h"
#include "libhdr/render/framing.h"
#include "tools/hdr/options.h"
#include "tools/hdr/prt_file.h"

namespace hdr::tools {
namespace {

double horizontal_fov(double vertical_degrees, double aspect) {
  return 2 * std::atan(aspect * std::tan(0.5 * vertical_degrees * kDegree)) / kDegree;
}

bool names_a_file(const std::string& scene) {
  return Path(scene).has_extension() || std::filesystem::exists(scene);
}

}  // namespace

void MeshFlags::declare(CLI::App& app) {
  app.add_option("--shading", shading,
                 "normals of meshes. auto: the file's own; where it has none, OBJ is smooth and others show facets")
      ->check(CLI::IsMember({"auto", "flat", "smooth"}))
      ->capture_default_str();
  app.add_option("--up", up, "which axis of the file points up")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
}

ReadSceneOptions MeshFlags::options() const {
  ReadSceneOptions options;
  options.shading = shading == "flat" ? Shading::kFlat : shading == "smooth" ? Shading::kSmooth : Shading::kAuto;
  options.z_up = up == "z";
  return options;
}

SceneFile read_meshes(Run& run, const std::string& path, const MeshFlags& flags) {
  SceneFile file = read_scene(path, flags.options());
  for (const std::string& warning : file.warnings) run.warn(warning);
  return file;
}

void CameraFlags::declare(CLI::App& app) {
  app.add_option("--eye", eye, "the camera's place X,Y,Z, +Y up (default: the file's camera, or one that sees all)");
  app.add_option("--look", look, "the point it looks at");
  app.add_option("--fov", fov, "horizontal, degrees");
}

void CameraFlags::apply_to(Camera& camera) const {
  if (!eye.empty()) camera.eye = vec3_from_text(eye, "--eye").cast<float>();
  if (!look.empty()) camera.look = vec3_from_text(look, "--look").cast<float>();
  if (!eye.empty() || !look.empty()) camera.up = {0, 1, 0};
  if (fov) camera.fov_degrees = *fov;
  if (!(camera.fov_degrees > 0 && camera.fov_degrees < 180)) throw Error("--fov: give degrees between 0 and 180");
  if (!camera.eye.allFinite() || !camera.look.allFinite() || (camera.eye - camera.look).norm() == 0)
    throw Error("--eye and --look are the same point; move one of them");
}

void SceneInput::declare(CLI::App& app) {
  app.add_option("--scene", scene,
                 "`sphere` is one sphere alone, `macbeth` a grey ball, a colour chart and a chrome ball on the probe's "
                 "own ground; a "
                 "mesh (.obj .ply .gltf .glb), or a .prt of `hdr prt` (default: spheres "
                 "on a plane)");
  app.add_option("--material", material,
                 "of a mesh, in place of the file's, and of the sphere: diffuse:ALBEDO, ggx:ROUGHNESS, phong:EXPONENT, "
                 "mirror");
  camera.declare(app);
  mesh.declare(app);
}

SceneInput::Loaded SceneInput::read(Run& run, Size picture) const {
  Loaded loaded;
  Scene& into = loaded.scene;
  const double aspect = static_cast<double>(picture.width) / picture.height;
  const Material given = material_from_text(material.empty() ? "diffuse:0.5" : material);
  std::optional<double> vertical_fov;
  if (scene.empty()) {
    into = spheres_on_plane();
  } else if (scene == "sphere") {
    into = sphere_alone(given);
  } else if (scene == "macbeth") {
    into = colour_chart_set();
  } else if (Path(scene).extension() == ".prt") {
    PrtMesh prt = read_prt(scene);
    prt.mesh.material = given;
    into.meshes.push_back(std::move(prt.mesh));
    loaded.transfer.push_back(std::move(prt.transfer));
  } else if (names_a_file(scene)) {
    SceneFile file = read_meshes(run, scene, mesh);
    into = std::move(file.scene);
    vertical_fov = file.vertical_fov_degrees;
    if (!material.empty())
      for (Mesh& each : into.meshes) each.material = given;
    run.answer["triangles"] = file.triangles;
    if (file.degenerate > 0) run.answer["degenerate"] = file.degenerate;
  } else {
    throw Error(
        scene +
        ": not a scene of this build; leave --scene out for spheres on a plane, or pass sphere, macbeth, a mesh "
        "(.obj .ply .gltf .glb) or one with its transfer (.prt)");
  }
  const bool built_in = scene.empty() || scene == "sphere" || scene == "macbeth";
  if (vertical_fov) {
    into.camera.fov_degrees = horizontal_fov(*vertical_fov, aspect);
  } else if (!built_in) {
    into.camera = framing_camera(into, aspect, camera.fov.value_or(40));
    // From a given place one looks at the middle.
    if (!camera.eye.empty()) into.camera.look = middle_of(into);
  }
  camera.apply_to(into.camera);
  return loaded;
}

}  // namespace hdr::tools
