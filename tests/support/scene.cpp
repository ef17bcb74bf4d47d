#include "tests/support/scene.h"

#include <cmath>
#include <vector>

#include "libhdr/core/random.h"

namespace hdr::test {

Image<float> test_scene(int width, int height, double stops, std::uint64_t seed) {
  Image<float> scene(width, height, 3);
  Random random(seed, 0);
  // A sum of a ramp across the range, a few waves and hard-edged boxes, in log2.
  struct Wave {
    double fx, fy, phase, size;
  };
  std::vector<Wave> waves;
  for (int k = 0; k < 12; ++k) {
    const double f = std::exp2(k * 0.5);
    waves.push_back({f * random.normal(), f * random.normal(), 6.28 * random.uniform(), 0.5 / std::sqrt(f)});
  }
  struct Box {
    double x0, y0, x1, y1, value[3];
  };
  std::vector<Box> boxes;
  for (int k = 0; k < 16; ++k) {
    const double x = random.uniform(), y = random.uniform();
    Box box{x, y, x + 0.05 + 0.15 * random.uniform(), y + 0.05 + 0.15 * random.uniform(), {}};
    const double grey = 2 * random.normal();
    for (double& v : box.value) v = grey + 0.3 * random.normal();
    boxes.push_back(box);
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5) / width, v = (y + 0.5) / height;
      double wave = 0;
      for (const Wave& w : waves) wave += w.size * std::sin(6.28 * (w.fx * u + w.fy * v) + w.phase);
      for (int c = 0; c < 3; ++c) {
        double value = stops * (u - 0.5) + wave + 0.2 * (c - 1) * (v - 0.5);
        for (const Box& b : boxes) {
          if (u >= b.x0 && u < b.x1 && v >= b.y0 && v < b.y1) value += b.value[c];
        }
        scene(x, y, c) = static_cast<float>(std::exp2(value));
      }
    }
  }
  return scene;
}

}  // namespace hdr::test
