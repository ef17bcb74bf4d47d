#include "libhdr/probe/internal/photo_agreement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "tests/support/carpet.h"

namespace hdr {
namespace {

constexpr Rectilinear kLens{{480, 360}, 80};

Image<float> view_of(const test::Carpet& world, const Mat3& world_from_view, double gain) {
  Image<float> picture(kLens.size, 3);
  for (int y = 0; y < kLens.size.height; ++y) {
    for (int x = 0; x < kLens.size.width; ++x) {
      const double light = gain * world(world_from_view * kLens.dir_from_px({x + 0.5, y + 0.5}).value());
      for (int c = 0; c < 3; ++c) picture(x, y, c) = static_cast<float>(light);
    }
  }
  return picture;
}

TEST(PhotoAgreement, IsOneOfTheSameAndNoneOfOtherThings) {
  const Mat3 turn = rotation_from_degrees({2, 40, -3});
  const test::Carpet here(1), elsewhere(2);
  const internal::PhotoDetail first(view_of(here, Mat3::Identity(), 1));
  const internal::PhotoDetail second(view_of(here, turn, 0.2)), other(view_of(elsewhere, turn, 0.2));
  const internal::Agreement same = first.agreement(kLens, second, kLens, turn);
  EXPECT_GT(same.correlation, 0.97) << "whatever its gain";
  EXPECT_NEAR(same.share, 0.5, 0.1) << "half a field to the side";
  EXPECT_GT(same.contrast, 0.1);
  EXPECT_LT(std::abs(first.agreement(kLens, other, kLens, turn).correlation), 0.2);
  EXPECT_LT(first.agreement(kLens, second, kLens, rotation_from_degrees({2, 50, -3})).correlation, 0.5)
      << "ten degrees off";
}

TEST(PhotoAgreement, WithoutOverlapOrDetailThereIsNone) {
  const test::Carpet world(3);
  const internal::PhotoDetail picture(view_of(world, Mat3::Identity(), 1));
  EXPECT_EQ(picture.agreement(kLens, picture, kLens, rotation_from_degrees({0, 180, 0})).share, 0);
  Image<float> grey(kLens.size, 3);
  for (int y = 0; y < kLens.size.height; ++y) std::fill_n(grey.row(y), 3 * kLens.size.width, 0.5f);
  const internal::Agreement none = picture.agreement(kLens, internal::PhotoDetail(grey), kLens, Mat3::Identity());
  EXPECT_NEAR(none.share, 1, 0.02);
  EXPECT_LT(none.contrast, 1e-4);
}

}  // namespace
}  // namespace hdr
