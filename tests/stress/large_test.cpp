// Beyond 2^31 samples and 2^32 bytes. Pages of zeros cost no memory until they are written, so pictures of that size
// are made where the system gives out the addresses, with light in their last pixels, where an int has overflowed.
#include <gtest/gtest.h>

#include <new>
#include <optional>

#include "libhdr/core/image.h"

namespace hdr::stress {
namespace {

constexpr Size kLarge{40000, 20000};  // 2.4e9 samples of three channels, 9.6e9 bytes of float

template <class T>
std::optional<Image<T>> large_image(int channels) {
  try {
    return Image<T>(kLarge, channels);
  } catch (const std::bad_alloc&) {
    return std::nullopt;
  }
}

TEST(LargeStress, TheLastPixelIsWhereItBelongs) {
  auto image = large_image<float>(3);
  if (!image) GTEST_SKIP() << "this system does not give out 9.6 GB of addresses";
  const int x = kLarge.width - 1, y = kLarge.height - 1;
  (*image)(x, y, 2) = 7;
  EXPECT_EQ(image->pixel(x, y) - image->row(0),
            static_cast<std::ptrdiff_t>(image->stride()) * y + 3 * std::ptrdiff_t{x});
  EXPECT_GT(image->pixel(x, y) - image->row(0), std::ptrdiff_t{1} << 31);
  EXPECT_EQ(image->view()(x, y, 2), 7);
  EXPECT_EQ((*image)(x, y - 1, 2), 0);
  const View<const float> last = image->view().rows(y, y + 1);
  EXPECT_EQ(last(x, 0, 2), 7);
}

TEST(LargeStress, APictureThatCannotBeIsRefused) {
  EXPECT_THROW(Image<float>(2000000000, 2000000000, 4), std::bad_alloc);
}

}  // namespace
}  // namespace hdr::stress
