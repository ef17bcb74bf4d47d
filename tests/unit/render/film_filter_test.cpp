// The film's filter: what is drawn has its density.
#include "libhdr/render/internal/film_filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

TEST(FilmFilter, DrawsItsWindow) {
  constexpr int kCount = 200000, kBins = 30;
  std::vector<int> bins(kBins, 0);
  double mean = 0, squares = 0;
  for (int k = 0; k < kCount; ++k) {
    const double u = (k + 0.5) / kCount;
    const Vec2 place = filtered_place(FilmFilter::kBlackmanHarris, {u, 0.5});
    EXPECT_NEAR(place.y(), 0.5, 1e-6);
    const double t = place.x() - 0.5;
    ASSERT_LE(std::abs(t), 1.5);
    ++bins[static_cast<std::size_t>(std::min(kBins - 1, static_cast<int>((t + 1.5) / 3 * kBins)))];
    mean += t / kCount;
    squares += t * t / kCount;
  }
  EXPECT_NEAR(mean, 0, 1e-6);
  double variance = 0, whole = 0;
  const auto window = [](double t) {  // t in [-1.5, 1.5]
    const double x = 2 * kPi * t / 3;
    return 0.35875 + 0.48829 * std::cos(x) + 0.14128 * std::cos(2 * x) + 0.01168 * std::cos(3 * x);
  };
  for (int k = 0; k < 3000; ++k) {
    const double t = 3 * (k + 0.5) / 3000 - 1.5;
    whole += window(t);
    variance += window(t) * t * t;
  }
  EXPECT_NEAR(squares, variance / whole, 1e-4);
  for (int bin = 0; bin < kBins; ++bin) {
    double expected = 0;
    for (int k = 0; k < 100; ++k) expected += window(3 * (bin + (k + 0.5) / 100) / kBins - 1.5) / 100;
    expected *= 3000.0 / kBins / whole;
    EXPECT_NEAR(static_cast<double>(bins[static_cast<std::size_t>(bin)]) / kCount, expected, 1e-4) << bin;
  }
  EXPECT_EQ(filtered_place(FilmFilter::kBox, {0.25, 0.75}), Vec2(0.25, 0.75));
}

}  // namespace
}  // namespace hdr
