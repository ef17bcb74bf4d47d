#include "libhdr/filter/fuse.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/error.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

/// A scene of `stops` stops, exposed `ev` more, as gamma codes.
Photo exposed(const Image<float>& scene, double ev) {
  Photo photo;
  Image<std::uint8_t> codes(scene.size(), 3);
  for (int y = 0; y < scene.height(); ++y) {
    for (std::size_t k = 0; k < scene.row_samples(); ++k) {
      const double level = std::min(1.0, scene.row(y)[k] * std::exp2(ev));
      codes.row(y)[k] = static_cast<std::uint8_t>(std::lround(255 * std::pow(level, 1 / 2.2)));
    }
  }
  photo.codes = std::move(codes);
  return photo;
}

TEST(Fuse, OneShotIsItself) {
  const Image<float> scene = test::test_scene(90, 61, 5, 1);
  const Image<float> fused = fuse(1, [&](int) { return exposed(scene, -2); });
  const Photo shot = exposed(scene, -2);
  const auto& codes = std::get<Image<std::uint8_t>>(shot.codes);
  for (int y = 0; y < 61; ++y) {
    for (std::size_t k = 0; k < fused.row_samples(); ++k) EXPECT_NEAR(fused.row(y)[k], codes.row(y)[k] / 255.0, 1e-5);
  }
}

TEST(Fuse, TakesEachPartFromTheShotThatShowsIt) {
  // Left 8 stops darker than right, both textured: no single shot has both.
  Image<float> scene = test::test_scene(256, 128, 1, 5);
  for (int y = 0; y < 128; ++y) {
    for (int k = 0; k < 3 * 128; ++k) scene.row(y)[k] *= 1 / 256.0f;
  }
  const auto shot = [&](int k) { return exposed(scene, std::array{-2.0, 2.0, 6.0}[static_cast<std::size_t>(k)]); };
  const Image<float> fused = fuse(3, shot);
  for (const int x : {60, 200}) {
    double sum = 0, squares = 0;
    constexpr int kCount = 68 * 40;
    for (int y = 30; y < 98; ++y) {
      for (int dx = -20; dx < 20; ++dx) {
        sum += fused(x + dx, y, 1);
        squares += fused(x + dx, y, 1) * fused(x + dx, y, 1);
      }
    }
    const double mean = sum / kCount;
    EXPECT_GT(mean, 0.25) << "column " << x << " is not black";
    EXPECT_LT(mean, 0.92) << "column " << x << " is not clipped";
    EXPECT_GT(std::sqrt(squares / kCount - mean * mean), 0.02) << "and has its texture";
  }
  const Image<float> again = fuse(3, [&](int k) { return shot(2 - k); });
  for (int y = 0; y < 128; ++y) {
    for (std::size_t k = 0; k < fused.row_samples(); ++k)
      ASSERT_NEAR(again.row(y)[k], fused.row(y)[k], 1e-5) << "any order";
  }
}

TEST(Fuse, RefusesWhatIsNoBracket) {
  const Image<float> small = test::test_scene(8, 8, 2, 1), large = test::test_scene(9, 8, 2, 1);
  EXPECT_THROW(fuse(2, [&](int k) { return exposed(k ? large : small, 0); }), Error);
  EXPECT_THROW(fuse(0, [&](int) { return exposed(small, 0); }), Error);
}

}  // namespace
}  // namespace hdr
