#include "tests/bench/rivals/cycles.h"

#include <fmt/format.h>

#include <sstream>

#include "libhdr/io/output_file.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "libhdr/probe/convention.h"
#include "libhdr/probe/unwrap.h"
#include "tests/bench/rivals/cycles_script.h"
#include "tests/bench/rivals/programs.h"
#include "tests/support/scratch.h"

namespace hdr::bench {
namespace {

/// Our (x, y, z) is Blender's (x, -z, y): +Z up.
Vec3f blender_from_ours(const Vec3f& p) {
  return {p.x(), -p.z(), p.y()};
}

std::string numbers(const Vec3f& p, const char* between) {
  return fmt::format("{:.9g}{}{:.9g}{}{:.9g}", p.x(), between, p.y(), between, p.z());
}

std::string text_of_meshes(const Scene& scene) {
  std::string vertices, triangles;
  std::size_t vertex_count = 0, triangle_count = 0;
  for (const Mesh& mesh : scene.meshes) {
    const bool smooth = !mesh.normals.empty();
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3f normal = smooth ? mesh.normals[v] : Vec3f(Vec3f::Zero());
      vertices +=
          numbers(blender_from_ours(mesh.positions[v]), " ") + " " + numbers(blender_from_ours(normal), " ") + "\n";
    }
    for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
      triangles += fmt::format("{} {} {} {:d}\n", vertex_count + mesh.indices[k], vertex_count + mesh.indices[k + 1],
                               vertex_count + mesh.indices[k + 2], smooth);
    }
    vertex_count += mesh.positions.size();
    triangle_count += mesh.indices.size() / 3;
  }
  return fmt::format("{} {}\n", vertex_count, triangle_count) + vertices + triangles;
}

}  // namespace

bool cycles_is_here() {
  return find_program("blender").has_value();
}

std::vector<CyclesRun> render_by_cycles(const Scene& scene, View<const float> latlong, Size size,
                                        const std::vector<int>& samples, int threads, const Path& scratch) {
  RadianceMap map;
  const LatLong projection{latlong.size()};
  map.rgb = resample(latlong, projection, projection, latlong.size(),
                     openexr_from_convention(Convention::kBlender).transpose());  // source_from_probe
  write_map(scratch / "map.exr", map, {}, {SampleType::kFloat, "zip", false});
  write_text(scratch / "mesh.txt", text_of_meshes(scene));
  write_text(scratch / "cycles.py", kCyclesScript);
  std::vector<std::string> line = {"blender",
                                   "-b",
                                   "-noaudio",
                                   "-P",
                                   (scratch / "cycles.py").string(),
                                   "--",
                                   scratch.string(),
                                   std::to_string(size.width),
                                   std::to_string(size.height),
                                   std::to_string(threads),
                                   fmt::format("{:g}", scene.camera.fov_degrees),
                                   numbers(blender_from_ours(scene.camera.eye), ","),
                                   numbers(blender_from_ours(scene.camera.look), ",")};
  for (const int n : samples) line.push_back(std::to_string(n));
  const support::ProgramResult result = support::run_program(line);
  std::vector<CyclesRun> runs;
  std::istringstream lines(result.out);
  for (std::string text; std::getline(lines, text);) {
    CyclesRun run;
    if (std::sscanf(text.c_str(), "RENDER %d %lf %lf", &run.samples, &run.cpu_seconds, &run.wall_seconds) == 3) {
      runs.push_back(std::move(run));
    }
  }
  if (runs.size() != samples.size()) {
    throw Error("blender failed: " + result.err.substr(0, result.err.find('\n')));
  }
  for (CyclesRun& run : runs) run.picture = read_map(scratch / fmt::format("{}.exr", run.samples)).map;
  return runs;
}

}  // namespace hdr::bench
