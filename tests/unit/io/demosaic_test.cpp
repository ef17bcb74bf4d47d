// Known pictures through a Bayer filter and back.
#include "libhdr/io/demosaic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/support.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

using Words = Image<std::uint16_t>;

constexpr Cfa kPatterns[] = {Cfa::kRggb, Cfa::kBggr, Cfa::kGrbg, Cfa::kGbrg};

/// What the sensor counts of `linear` (1 = white level).
Mosaic mosaic_of(const Image<float>& linear, Cfa cfa, double black, double white) {
  Mosaic mosaic;
  mosaic.codes = Words(linear.size(), 1);
  mosaic.cfa = cfa;
  mosaic.black_level.fill(black);
  mosaic.white_level = white;
  for (int y = 0; y < linear.height(); ++y) {
    for (int x = 0; x < linear.width(); ++x) {
      const double level = linear(x, y, cfa_channel(cfa, x, y));
      mosaic.codes(x, y) =
          static_cast<std::uint16_t>(std::lround(black + (white - black) * std::clamp(level, 0.0, 1.0)));
    }
  }
  return mosaic;
}

/// A scene with edges and texture whose brightest sample is `top` of the white level.
Image<float> scene_up_to(double top, std::uint64_t seed) {
  Image<float> scene = test::test_scene(160, 120, 6, seed);
  float brightest = 0;
  for (int y = 0; y < scene.height(); ++y) {
    brightest = std::max(brightest, *std::max_element(scene.row(y), scene.row(y) + scene.row_samples()));
  }
  for (int y = 0; y < scene.height(); ++y) {
    for (std::size_t k = 0; k < scene.row_samples(); ++k) scene.row(y)[k] *= static_cast<float>(top) / brightest;
  }
  return scene;
}

TEST(Demosaic, BlackBesideOneLevelStaysBlackInEveryPattern) {
  constexpr std::uint16_t kLevel = 40000;
  for (const Cfa cfa : kPatterns) {
    Mosaic mosaic;
    mosaic.cfa = cfa;
    mosaic.white_level = 65535;
    mosaic.codes = Words({64, 48}, 1);  // its left half is lit
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) mosaic.codes(x, y) = x < 32 ? kLevel : 0;
    }
    const Photo photo = demosaic(mosaic);
    const auto& codes = std::get<Words>(photo.codes);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        if (x > 27 && x < 36) continue;  // the edge
        for (int c = 0; c < 3; ++c) {
          ASSERT_NEAR(codes(x, y, c), x < 32 ? kLevel : 0, 2) << x << "," << y << " channel " << c;
        }
      }
    }
  }
}

TEST(Demosaic, OneColourStaysOneColourInEveryPatternAtEveryPlace) {
  constexpr std::uint16_t kColour[3] = {9000, 30000, 17000};
  for (const Cfa cfa : kPatterns) {
    for (const Size size : {Size{16, 16}, Size{37, 25}, Size{64, 48}}) {
      Mosaic mosaic;
      mosaic.cfa = cfa;
      mosaic.codes = Words(size, 1);
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) mosaic.codes(x, y) = kColour[cfa_channel(cfa, x, y)];
      }
      const Photo photo = demosaic(mosaic);
      ASSERT_EQ(photo.size(), size);
      ASSERT_EQ(photo.bits, 16);
      const Words& codes = std::get<Words>(photo.codes);
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(codes(x, y, c), kColour[c], 2)
                << "pattern " << static_cast<int>(cfa) << " at " << x << "," << y << " channel " << c;
          }
        }
      }
    }
  }
}

TEST(Demosaic, BlackIsZeroWhiteIsFullScaleAndWhatWasSeenStays) {
  for (const Cfa cfa : kPatterns) {
    const Image<float> scene = scene_up_to(0.9, 3);
    const Mosaic mosaic = mosaic_of(scene, cfa, 64, 1023);
    const Words codes = std::move(std::get<Words>(demosaic(mosaic).codes));
    for (int y = 0; y < scene.height(); ++y) {
      for (int x = 0; x < scene.width(); ++x) {
        ASSERT_EQ(codes(x, y, cfa_channel(cfa, x, y)), std::lround((mosaic.codes(x, y) - 64) * 65535.0 / (1023 - 64)));
      }
    }
  }
  Mosaic dark;
  dark.codes = Words(16, 16, 1);
  dark.black_level.fill(64);
  dark.white_level = 1023;
  EXPECT_EQ(std::get<Words>(demosaic(dark).codes)(5, 5, 0), 0) << "noise below the black level is no light";
}

/// The obvious way: the mean of the samples of that colour in the 3x3 pixels around.
double bilinear(const Mosaic& mosaic, int x, int y, int channel) {
  if (cfa_channel(mosaic.cfa, x, y) == channel) return mosaic.codes(x, y);
  double sum = 0, count = 0;
  for (int ny = std::max(0, y - 1); ny <= std::min(mosaic.codes.height() - 1, y + 1); ++ny) {
    for (int nx = std::max(0, x - 1); nx <= std::min(mosaic.codes.width() - 1, x + 1); ++nx) {
      if (cfa_channel(mosaic.cfa, nx, ny) != channel) continue;
      sum += mosaic.codes(nx, ny);
      ++count;
    }
  }
  return sum / count;
}

TEST(Demosaic, ComesCloseToThePicture) {
  for (const Cfa cfa : kPatterns) {
    const Image<float> scene = scene_up_to(0.95, 11);
    const Mosaic mosaic = mosaic_of(scene, cfa, 0, 65535);
    const Words codes = std::move(std::get<Words>(demosaic(mosaic).codes));
    double squares = 0, plain_squares = 0;
    for (int y = 0; y < scene.height(); ++y) {
      for (int x = 0; x < scene.width(); ++x) {
        for (int c = 0; c < 3; ++c) {
          squares += std::pow(codes(x, y, c) / 65535.0 - scene(x, y, c), 2);
          plain_squares += std::pow(bilinear(mosaic, x, y, c) / 65535.0 - scene(x, y, c), 2);
        }
      }
    }
    const double samples = 3.0 * scene.width() * scene.height();
    const double psnr = -10 * std::log10(squares / samples), plain = -10 * std::log10(plain_squares / samples);
    EXPECT_GT(psnr, 43) << "44.6 to 48.2 dB when it was written; pattern " << static_cast<int>(cfa);
    EXPECT_GT(psnr, plain + 2) << "against bilinear interpolation; pattern " << static_cast<int>(cfa);
  }
}

TEST(Demosaic, TwiceTheLightIsTwiceTheCode) {
  const Image<float> bright = scene_up_to(0.9, 5), dim = scene_up_to(0.45, 5);
  const Words a = std::move(std::get<Words>(demosaic(mosaic_of(bright, Cfa::kRggb, 0, 65535)).codes));
  const Words b = std::move(std::get<Words>(demosaic(mosaic_of(dim, Cfa::kRggb, 0, 65535)).codes));
  int off = 0, counted = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (std::size_t k = 0; k < a.row_samples(); ++k) {
      if (b.row(y)[k] < 200) continue;
      ++counted;
      if (std::abs(a.row(y)[k] - 2.0 * b.row(y)[k]) > 0.01 * a.row(y)[k]) ++off;
    }
  }
  EXPECT_GT(counted, 10000);
  EXPECT_LT(off, counted / 100) << "the direction of interpolation may turn where both are equally good";
}

TEST(Demosaic, AColourNextToASaturatedSampleOfItIsSaturated) {
  Mosaic mosaic;
  mosaic.codes = Words(32, 32, 1);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) mosaic.codes(x, y) = 20000;
  }
  mosaic.white_level = 60000;
  mosaic.codes(16, 16) = 60000;  // red in RGGB
  const Words codes = std::move(std::get<Words>(demosaic(mosaic).codes));
  for (int y = 12; y <= 20; ++y) {
    for (int x = 12; x <= 20; ++x) {
      const bool near = std::abs(x - 16) <= 1 && std::abs(y - 16) <= 1;
      EXPECT_EQ(codes(x, y, 0) == 65535, near) << x << "," << y;
      EXPECT_LT(codes(x, y, 1), 65535);
      EXPECT_LT(codes(x, y, 2), 65535);
    }
  }
}

TEST(Demosaic, WhatCannotBeDevelopedSaysWhy) {
  Mosaic mosaic;
  mosaic.codes = Words(8, 8, 1);
  EXPECT_NE(test::error_of([&] { demosaic(mosaic); }).find("8x8"), std::string::npos);
  mosaic.codes = Words(32, 32, 1);
  mosaic.black_level.fill(300);
  mosaic.white_level = 255;
  EXPECT_NE(test::error_of([&] { demosaic(mosaic); }).find("black level 300"), std::string::npos);
}

}  // namespace
}  // namespace hdr
