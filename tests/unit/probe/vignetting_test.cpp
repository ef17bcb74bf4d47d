#include "libhdr/probe/vignetting.h"

#include <gtest/gtest.h>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

RadianceMap flat(Size size) {
  RadianceMap map;
  map.rgb = Image<float>(size, 3);
  map.stddev = Image<float>(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < 3 * size.width; ++x) {
      map.rgb.row(y)[x] = 2;
      map.stddev.row(y)[x] = 0.1f;
    }
  }
  return map;
}

TEST(Vignetting, IsDividedOutByTheHalfDiagonal) {
  RadianceMap map = flat({60, 80});
  divide_vignetting(map, {-0.3, 0.1, -0.05});
  // Pixel (59, 79): its centre is 29.5, 39.5 from the middle; the half-diagonal is 50.
  const double r2 = (29.5 * 29.5 + 39.5 * 39.5) / 2500, left = 1 - 0.3 * r2 + 0.1 * r2 * r2 - 0.05 * r2 * r2 * r2;
  EXPECT_NEAR(map.rgb(59, 79, 1), 2 / left, 1e-5);
  EXPECT_NEAR(map.stddev(59, 79, 2), 0.1 / left, 1e-6);
  EXPECT_NEAR(map.rgb(0, 0, 0), 2 / left, 1e-5) << "it is symmetric";
  EXPECT_NEAR(map.rgb(30, 40, 0), 2, 1e-3) << "and 1 in the middle";
}

TEST(Vignetting, WhatLeavesNoLightIsRefused) {
  RadianceMap map = flat({8, 8});
  EXPECT_THROW(divide_vignetting(map, {-1, 0, 0}), Error);
  EXPECT_THROW(divide_vignetting(map, {-4, 4, 0}), Error) << "black half way out";
}

}  // namespace
}  // namespace hdr
