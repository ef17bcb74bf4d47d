// A two-fisheye camera's photographs: front and back become one sphere.
#include "libhdr/probe/fisheye_pair.h"

#include <gtest/gtest.h>

#include <string>

#include "libhdr/io/read.h"
#include "libhdr/probe/find_image_circle.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

TEST(RealFisheyes, ATwoFisheyeCamerasPicturesMeet) {
  HDR_NEED_SHARED_DATA(folder, "fisheye/gopro_fusion_3k/directory");
  for (const char* shot : {"img1", "img2"}) {
    const RadianceMap front = read_map(folder / "FR" / ("GPFR0003_" + std::string(shot) + ".jpg")).map;
    const RadianceMap back = read_map(folder / "BK" / ("GPBK0003_" + std::string(shot) + ".jpg")).map;
    const auto a = find_image_circle(front.rgb), b = find_image_circle(back.rgb);
    ASSERT_TRUE(a && b);
    const FisheyePair pair = solve_fisheye_pair(front.rgb, back.rgb, {a->disc, 190}, {b->disc, 190});
    EXPECT_GT(pair.matches, 100) << shot;
    EXPECT_LT(pair.residual_degrees * 3072 / 360, 2) << shot << ": pixels of a lat-long 3072 wide";
  }
}

}  // namespace
}  // namespace hdr
