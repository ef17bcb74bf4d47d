// The unbiased modes have no floor: their error falls as the root of the work, to one per cent and on.
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/render.h"

namespace hdr {
namespace {

Image<float> sunny_map() {
  Image<float> map(128, 64, 3);
  const Vec3 sun = Vec3(0.5, 0.7, 0.6).normalized();
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 128; ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / 128, (y + 0.5) / 64);
      for (int c = 0; c < 3; ++c)
        map(x, y, c) = (d.y() > 0 ? 1.0f : 0.3f) + (d.dot(sun) > std::cos(4 * kDegree) ? 150.0f : 0.0f);
    }
  }
  return map;
}

double error_of(const Rendering& r, const Rendering& truth) {
  double squares = 0;
  int count = 0;
  for (int y = 0; y < truth.picture.rgb.height(); ++y) {
    for (int x = 0; x < truth.picture.rgb.width(); ++x) {
      if (truth.picture.alpha(x, y) < 1 || r.picture.alpha(x, y) < 1) continue;
      squares += std::pow(static_cast<double>(r.picture.rgb(x, y, 1) / truth.picture.rgb(x, y, 1)) - 1, 2);
      ++count;
    }
  }
  return std::sqrt(squares / count);
}

TEST(Render, ErrorFallsAsTheRootOfTheWork) {
  Scene scene = spheres_on_plane();
  for (Mesh& mesh : scene.meshes) mesh.material = material_from_text("diffuse:0.5");
  const Environment light(sunny_map(), Environment::Density::kCompensated);
  constexpr Size kSize{24, 18};
  const Rendering truth = render(scene, light, {RenderMethod::kMis, kSize, 1 << 15, 4711, {}});
  for (const RenderMethod method : {RenderMethod::kMis, RenderMethod::kAuto}) {
    std::vector<double> errors;
    for (int samples = 16; samples <= 4096; samples *= 4)
      errors.push_back(error_of(render(scene, light, {method, kSize, samples, 1, {}}), truth));
    for (std::size_t k = 1; k < errors.size(); ++k)
      EXPECT_LT(errors[k], 0.7 * errors[k - 1]) << name_of(method) << ", step " << k;
    EXPECT_LT(errors.back(), errors.front() / 16 * 1.3) << name_of(method) << ": 256 times the work";
    EXPECT_LT(errors.back(), 0.01) << name_of(method);
  }
}

}  // namespace
}  // namespace hdr
