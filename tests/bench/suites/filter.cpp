// Gaussian blurs: a cost that does not follow sigma, beside OpenCV's, which does.
#include <fmt/format.h>

#include "libhdr/core/parallel.h"
#include "libhdr/filter/blur.h"
#include "tests/bench/exact_gaussian.h"
#include "tests/bench/rivals/opencv_blur.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/suite.h"
#include "tests/support/scene.h"

namespace hdr::bench {
namespace {

Image<float> test_map(Size size) {
  Image<float> map = test::test_scene(size.width, size.height, 10, 3);
  for (int c = 0; c < 3; ++c) map(size.width / 2, size.height / 3, c) = 1e4f;
  return map;
}

}  // namespace

void filter_suite(Bench& bench) {
  const Size size = bench.pick(Size{512, 256}, Size{4096, 2048});
  const Image<float> map = test_map(size);
  Image<float> ours, theirs(size, 3);
  for (const double sigma : bench.quick() ? std::vector<double>{2, 5, 10, 20} : std::vector<double>{2, 5, 10, 20, 50}) {
    Row row{"filter", fmt::format("Gaussian blur of a {}x{} map", size.width, size.height), "hdr", "sigma"};
    row.value = sigma;
    row.error_name = "worst of twelve pixels, against the exact sum";
    row.error_unit = "%";
    row.megapixels = megapixels(size);
    Row other = row, sphere = row;
    row.setting = fmt::format("hdr filter in.exr --gaussian {} -o out.exr --plane", short_number(sigma));
    other.subject = "OpenCV GaussianBlur";
    sphere.subject = "hdr, on the sphere";
    sphere.error_name = sphere.error_unit = "";
    bench.race({{row, [&] { ours = gaussian_blur(map, sigma); },
                 [&] { return 100 * worst_gaussian_error(map, ours, sigma); }, 1},
                {other, [&] { opencv_gaussian(map, theirs, sigma, threads()); },
                 [&] { return 100 * worst_gaussian_error(map, theirs, sigma); }, 5},
                {sphere, [&] { gaussian_blur(map, sigma, Surface::kLatLong); }}});
  }
}

}  // namespace hdr::bench
