#include "tools/hdr/report/picture.h"

#include <gtest/gtest.h>

#include "tests/support/markup.h"
#include "tests/support/support.h"

namespace hdr::report {
namespace {

TEST(Reduced, KeepsTheMeanLightAndTheShape) {
  const Image<float> scene = test::test_scene(640, 360, 10, 3);
  const Image<float> small = reduced(scene.view(), 6400);
  EXPECT_EQ(small.size(), reduced_size({640, 360}, 6400));
  EXPECT_LE(small.width() * small.height(), 6400);
  EXPECT_NEAR(static_cast<double>(small.width()) / small.height(), 640.0 / 360, 0.03);
  double before = 0, after = 0;
  for (int y = 0; y < 360; ++y) {
    for (int x = 0; x < 640; ++x) before += scene(x, y, 1) / (640.0 * 360);
  }
  for (int y = 0; y < small.height(); ++y) {
    for (int x = 0; x < small.width(); ++x) after += small(x, y, 1) / (1.0 * small.width() * small.height());
  }
  EXPECT_NEAR(after / before, 1, 0.03);
}

TEST(Reduced, ALonePixelOfAMaskIsSeenWhereItIs) {
  const Size full{101, 67}, size = reduced_size(full, 900);
  for (int y = 0; y < full.height; y += 7) {
    for (int x = 0; x < full.width; x += 7) {
      Image<std::uint8_t> mask(full, 1);
      Image<float> light(full, 3);
      mask(x, y) = 200;
      light(x, y, 0) = 1;
      const Image<std::uint8_t> small = reduced(mask.view(), size);
      const Image<float> picture = reduced(light.view(), 900);
      int seen = 0;
      for (int v = 0; v < size.height; ++v) {
        for (int u = 0; u < size.width; ++u) {
          seen += small(u, v) == 200;
          EXPECT_EQ(small(u, v) > 0, picture(u, v, 0) > 0) << "the same cell as the picture's";
        }
      }
      EXPECT_EQ(seen, 1);
    }
  }
}

TEST(Reduced, ASmallPictureStaysAsItIs) {
  const Image<float> scene = test::test_scene(30, 20, 10, 3);
  const Image<float> same = reduced(scene.view(), 600);
  for (int y = 0; y < 20; ++y) {
    for (int k = 0; k < 90; ++k) ASSERT_EQ(same.row(y)[k], scene.row(y)[k]);
  }
}

TEST(Picture, IsWellFormed) {
  const Image<float> scene = test::test_scene(30, 20, 10, 3);
  const Image<std::uint8_t> mask(30, 20, 1);
  Page page("t", "s");
  const Picture picture{"map", scene, -1.7, {{"clipped <&>", mask}}, "<circle cx=\"5\" cy=\"5\" r=\"3\" class=\"c1\"/>",
                        {}};
  page.add({"map-section", "Map", html_of(picture, page)});
  EXPECT_EQ(test::fault_of_page(page.text()), "");
  EXPECT_NE(page.text().find("value=\"-1.5\""), std::string::npos) << "to the next half stop";
}

}  // namespace
}  // namespace hdr::report
