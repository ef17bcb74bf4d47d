// The vectors against the obvious sum, and both against the exact one.
#include "libhdr/light/internal/row_moments.h"

#include <gtest/gtest.h>

#include "tests/unit/light/maps.h"

namespace hdr {
namespace {

TEST(RowMoments, VectorsSayWhatTheReferenceSays) {
  Random random(31, 0);
  for (const int width : {4, 8, 12, 20, 36, 100, 512, 516, 1028, 1100}) {
    for (const int degree : {0, 1, 2, 5, 10}) {
      Image<float> map(width, 3, 3);
      for (int y = 0; y < 3; ++y)
        for (int k = 0; k < 3 * width; ++k) map.row(y)[k] = static_cast<float>(std::exp(10 * random.uniform()));
      const AzimuthTable table(width, degree);
      std::vector<double> fast(static_cast<std::size_t>(9 * table.count()), 1e30), slow(fast);
      row_moments(map, table, fast.data());
      reference::row_moments(map, table, slow.data());
      const auto row = static_cast<std::size_t>(3 * table.count());
      for (std::size_t k = 0; k < fast.size(); ++k) {
        const double light = slow[k / row * row + k % 3];  // of the row, in that channel
        EXPECT_NEAR(fast[k], slow[k], 1e-12 * light + 1e-9)
            << width << " wide, degree " << degree << ", number " << k;
      }
    }
  }
}

TEST(RowMoments, OnePixelHasTheExactIntegralsOfItsColumn) {
  constexpr int kWidth = 24, kDegree = 7;
  const AzimuthTable table(kWidth, kDegree);
  for (int x = 0; x < kWidth; ++x) {
    Image<float> map(kWidth, 1, 3);
    map(x, 0, 1) = 1;
    std::vector<double> moments(static_cast<std::size_t>(3 * table.count()));
    row_moments(map, table, moments.data());
    const double right = 2 * kPi * (0.5 - (x + 1.0) / kWidth), left = 2 * kPi * (0.5 - 1.0 * x / kWidth);
    for (int m = 1; m <= kDegree; ++m) {
      const auto k = static_cast<std::size_t>(3 * (2 * m - 1) + 1);
      EXPECT_NEAR(moments[k], (std::sin(m * left) - std::sin(m * right)) / m, 1e-14) << x << " cos " << m;
      EXPECT_NEAR(moments[k + 3], (std::cos(m * right) - std::cos(m * left)) / m, 1e-14) << x << " sin " << m;
      EXPECT_EQ(moments[k - 1], 0);
      EXPECT_EQ(moments[k + 1], 0);
    }
    EXPECT_NEAR(moments[1], 2 * kPi / kWidth, 1e-15);
  }
}

}  // namespace
}  // namespace hdr
