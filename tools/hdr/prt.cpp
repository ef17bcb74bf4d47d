#include "libhdr/render/prt.h"

#include <fmt/format.h>

#include "tools/hdr/prt_file.h"
#include "tools/hdr/scene_input.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

std::function<int(Run&)> declare_prt(CLI::App& app) {
  struct Options {
    std::string mesh, output, up = "y";
    TransferOptions transfer;
  };
  auto options = std::make_shared<Options>();
  app.add_option("mesh", options->mesh, "a mesh (.obj .ply .gltf .glb)")->required();
  app.add_option("-o,--output", options->output, "the mesh with its transfer, for  hdr render --scene")->required();
  app.add_option("--up", options->up, "which axis of the file points up")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  app.add_option("--degree", options->transfer.degree, "of the harmonics; 4 gives 25 numbers a vertex")
      ->check(CLI::Range(0, 12))
      ->capture_default_str();
  app.add_option("--samples", options->transfer.samples, "rays a vertex")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option("--seed", options->transfer.seed, "of the random numbers")->capture_default_str();
  return [options](Run& run) {
    Scene scene;
    // One mesh, whose vertices share their normals.
    scene.meshes.push_back(run.stage("read", [&] {
      return with_smooth_normals(joined(read_meshes(run, options->mesh, {"flat", options->up}).scene));
    }));
    const std::vector<Transfer> transfer = run.stage("transfer", [&](const Progress& progress) {
      TransferOptions settings = options->transfer;
      settings.progress = [&progress](double done) { progress.update(done); };
      return diffuse_transfer(scene, settings);
    });
    const auto vertices = scene.meshes[0].positions.size();
    run.answer["vertices"] = vertices;
    run.answer["triangles"] = scene.meshes[0].indices.size() / 3;
    run.answer["degree"] = options->transfer.degree;
    run.answer["rays"] = vertices * static_cast<std::size_t>(options->transfer.samples);
    run.stage("write", [&] { write_prt(options->output, {std::move(scene.meshes[0]), transfer[0]}); });
    run.say(fmt::format("{} vertices, degree {}\nwrote {}", vertices, options->transfer.degree, options->output));
    return 0;
  };
}

}  // namespace hdr::tools
