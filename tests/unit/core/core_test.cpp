#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>

#include "libhdr/core/error.h"
#include "libhdr/core/exposure.h"
#include "libhdr/core/image.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/stage.h"

namespace hdr {
namespace {

TEST(Image, RowsAreAlignedAndZeroAndCloneIsDeep) {
  Image<float> image(7, 5, 3);
  for (int y = 0; y < 5; ++y) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(image.row(y)) % Image<float>::kAlignment, 0u);
    for (int x = 0; x < 7; ++x) EXPECT_EQ(image(x, y, 2), 0.0f);
  }
  image(6, 4, 2) = 3;
  Image<float> copy = image.clone();
  image(6, 4, 2) = 4;
  EXPECT_EQ(copy(6, 4, 2), 3.0f);
  const Image<float> moved = std::move(copy);
  EXPECT_EQ(moved(6, 4, 2), 3.0f);
  EXPECT_TRUE(copy.empty()) << "a moved-from image is empty";  // NOLINT: that is the claim
}

TEST(ViewDeathTest, AStrideShorterThanARowIsOurBug) {
  float data[12] = {};
  EXPECT_DEATH(View<float>(data, 4, 1, 3, 11), "stride");
}

TEST(Exposure, RelativeExposureFollowsTimeIsoApertureAndDensity) {
  const Exposure base{1.0 / 60, 8.0, 100.0, 0};
  const Exposure brighter{1.0 / 30, 5.6568542494923806, 400.0, 1};
  EXPECT_NEAR(*brighter.relative() / *base.relative(), 2 * 2 * 4 / 2.0, 1e-12);
  EXPECT_FALSE(Exposure{}.relative().has_value());
}

TEST(Parallel, ReductionDoesNotDependOnThreads) {
  const auto sum = [] {
    return reduce_rows(
        1000, 7, 0.0f,
        [](int first, int last) {
          float s = 0;
          for (int y = first; y < last; ++y) s += 1.0f / static_cast<float>(y + 1);
          return s;
        },
        [](float& total, float part) { total += part; });
  };
  set_threads(1);
  const float one = sum();
  set_threads(4);
  const float four = sum();
  set_threads(0);
  EXPECT_EQ(one, four) << "float addition is not associative: blocks must be joined in order";
}

TEST(Parallel, EveryRowOnceAndExceptionsComeBack) {
  std::vector<std::atomic<int>> seen(103);
  for_rows(103, 10, [&](int first, int last) {
    for (int y = first; y < last; ++y) seen[static_cast<std::size_t>(y)]++;
  });
  for (const auto& count : seen) EXPECT_EQ(count, 1);
  EXPECT_THROW(for_rows(10, 1,
                        [](int first, int) {
                          if (first == 5) throw Error("row 5");
                        }),
               Error);
}

TEST(Random, IsAFunctionOfItsAddressAndUniform) {
  EXPECT_EQ(Random(1, 2, 3).bits(), Random(1, 2, 3).bits());
  EXPECT_NE(Random(1, 2, 3).bits(), Random(1, 2, 4).bits());
  // First numbers of neighbouring pixels must not correlate: their mean and variance are those of the uniform law.
  double sum = 0, squares = 0;
  const int n = 200000;
  for (int pixel = 0; pixel < n; ++pixel) {
    const double u = Random(7, 0, static_cast<std::uint64_t>(pixel)).uniform();
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / n, 0.5, 4 * std::sqrt(1.0 / 12 / n));
  EXPECT_NEAR(squares / n, 1.0 / 3, 4 * std::sqrt(4.0 / 45 / n));
}

TEST(StageClock, NamesTimesAndSkips) {
  StageClock clock;
  const int result = clock.run("align", [] { return 7; });
  clock.skipped("registered already, within 0.02 px");
  EXPECT_EQ(result, 7);
  ASSERT_EQ(clock.stages().size(), 1u);
  EXPECT_EQ(clock.stages()[0].name, "align");
  EXPECT_EQ(clock.stages()[0].skipped, "registered already, within 0.02 px");
  EXPECT_GE(clock.stages()[0].seconds, 0);
}

}  // namespace
}  // namespace hdr
