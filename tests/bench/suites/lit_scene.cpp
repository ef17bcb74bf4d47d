#include "tests/bench/suites/lit_scene.h"

#include "libhdr/core/error.h"
#include "libhdr/render/scene_file.h"
#include "tests/bench/render_scene.h"
#include "tests/bench/suites/light_map.h"

namespace hdr::bench {

Scene lit_scene(const Bench& bench) {
  const Path& file = bench.options().scene;
  if (file.empty()) return folded_ball_on_plane(bench.pick(90, 252));
  constexpr std::size_t kTriangles = 60000;
  return mesh_on_plane(joined(read_scene(file, {Shading::kFlat}).scene), kTriangles);
}

std::string scene_name(const Bench& bench) {
  return bench.options().scene.empty() ? "a folded ball" : bench.options().scene.stem().string();
}

Environment environment_of(const Bench& bench, int width, bool compensated) {
  return Environment(light_map(bench, width),
                     compensated ? Environment::Density::kCompensated : Environment::Density::kLuminance);
}

double percent_off(const RadianceMap& picture, const RadianceMap& reference) {
  if (picture.rgb.size() != reference.rgb.size()) return kUnknown;
  return 100 * rel_rmse(picture.rgb, reference.rgb, reference.alpha);
}

Rendering rendered(const Scene& scene, const Environment& light, const std::string& method, Size size, int samples,
                   std::uint64_t seed, int depth_maps) {
  const auto known = render_method_from_name(method);
  if (!known) throw Error("this build has no `hdr render --method " + method + "`");
  RenderOptions options;
  options.method = *known;
  options.size = size;
  options.samples = samples;
  options.seed = seed;
  options.depth_maps = depth_maps;
  return render(scene, light, options);
}

}  // namespace hdr::bench
