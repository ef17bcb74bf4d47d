// A published table: the nine coefficients of Grace Cathedral, [Ramamoorthi01] and their program.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "libhdr/io/read.h"
#include "libhdr/light/sh.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

// In our order and axes: their x is the image's right, ours -X, so L11, L2-2 and L21 change sign.
constexpr std::array<std::array<double, 3>, 9> kPublished{{{0.078908, 0.043710, 0.054161},
                                                           {0.039499, 0.034989, 0.060488},
                                                           {-0.033974, -0.018236, -0.026940},
                                                           {0.029213, 0.005562, -0.000944},
                                                           {0.011141, 0.005090, 0.012231},
                                                           {-0.026240, -0.022401, -0.047479},
                                                           {-0.015570, -0.009471, -0.014733},
                                                           {-0.056014, -0.021444, -0.013915},
                                                           {0.021205, -0.005432, -0.030374}}};
constexpr double kFileScale = 32;  ///< of this file over theirs

double worst_share_of_l00(const Sh& sh) {
  double worst = 0;
  for (std::size_t k = 0; k < 9; ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double ours = sh.coefficients[k][static_cast<int>(c)] / kFileScale;
      worst = std::max(worst, std::abs(ours - kPublished[k][c]) / kPublished[0][c]);
    }
  }
  return worst;
}

TEST(GraceCathedral, CoefficientsMeetThePublishedTable) {
  HDR_NEED_SHARED_DATA(path, "envmaps/grace_probe.hdr");
  const RadianceMap map = read_map(path).map;
  const int width = map.rgb.width();
  ASSERT_EQ(width, map.rgb.height());

  // Their pixel j stands at u = (j - w/2) / (w/2), without the half that puts it in its middle: the disc's centre lies
  // in the middle of pixel w/2.
  Disc theirs = inscribed_disc(width);
  theirs.cx += 0.5;
  theirs.cy += 0.5;
  EXPECT_LT(worst_share_of_l00(project(map.rgb, AngularMap{theirs}, 2)), 0.01);

  // Half a pixel in a thousand is less than that: our own rule meets the table too.
  EXPECT_LT(worst_share_of_l00(project(map.rgb, AngularMap{inscribed_disc(width)}, 2)), 0.01);
}

}  // namespace
}  // namespace hdr
