// Raw photographs out and in again; another reader's opinion of the files.
#include "libhdr/io/dng.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "libhdr/io/bracket.h"
#include "libhdr/io/demosaic.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

using test::error_of;
using test::ScratchDir;
using Words = Image<std::uint16_t>;

Mosaic made_up_mosaic(Size size, Cfa cfa, double black, double white, std::uint64_t seed) {
  Mosaic mosaic;
  mosaic.codes = Words(size, 1);
  mosaic.cfa = cfa;
  mosaic.black_level.fill(black);
  mosaic.white_level = white;
  mosaic.exposure = {1.0 / 60, 2.8, 200.0, 0};
  Random random(seed, 0, 0);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double level = 0.2 + 0.15 * std::sin(0.1 * x + 0.07 * y) + 0.05 * random.uniform();
      mosaic.codes(x, y) = static_cast<std::uint16_t>(black + level * (white - black));
    }
  }
  return mosaic;
}

TEST(Dng, EveryCodeComesBackWithPatternLevelsAndExposure) {
  const ScratchDir scratch;
  for (const Cfa cfa : {Cfa::kRggb, Cfa::kBggr, Cfa::kGrbg, Cfa::kGbrg}) {
    for (const auto& [black, white] : {std::pair{0.0, 255.0}, {64.0, 1023.0}, {256.0, 4095.0}, {4096.0, 65535.0}}) {
      const Mosaic mosaic = made_up_mosaic({62, 34}, cfa, black, white, 1);
      write_dng(scratch / "a.dng", mosaic, "Made-up 12");
      const Mosaic back = read_dng(scratch / "a.dng");
      ASSERT_EQ(back.codes.size(), mosaic.codes.size());
      EXPECT_EQ(back.cfa, cfa);
      EXPECT_EQ(back.black_level, mosaic.black_level);
      EXPECT_EQ(back.white_level, white);
      EXPECT_DOUBLE_EQ(back.exposure.seconds.value_or(0), 1.0 / 60);
      EXPECT_DOUBLE_EQ(back.exposure.f_number.value_or(0), 2.8);
      EXPECT_DOUBLE_EQ(back.exposure.iso.value_or(0), 200);
      for (int y = 0; y < 34; ++y) {
        for (int x = 0; x < 62; ++x) ASSERT_EQ(back.codes(x, y), mosaic.codes(x, y)) << x << "," << y;
      }
    }
  }
}

TEST(Dng, AsAPhotographItIsWhatDemosaicGives) {
  const ScratchDir scratch;
  const Mosaic mosaic = made_up_mosaic({80, 60}, Cfa::kGbrg, 64, 1023, 2);
  write_dng(scratch / "a.dng", mosaic, "");
  const Photo direct = demosaic(mosaic), read = read_photo(scratch / "a.dng");
  EXPECT_EQ(read.bits, 16);
  EXPECT_FALSE(read.lossy);
  EXPECT_EQ(test::differing_samples(std::get<Words>(direct.codes), std::get<Words>(read.codes)), 0);
  const PhotoHeader header = read_photo_header(scratch / "a.dng");
  EXPECT_EQ(header.size, (Size{80, 60}));
  EXPECT_DOUBLE_EQ(header.exposure.seconds.value_or(0), 1.0 / 60);

  const auto rows = open_photo_rows(scratch / "a.dng", Size{70, 50});
  const CodesView some = rows->rows(20, 30);
  EXPECT_EQ(std::get<View<const std::uint16_t>>(some)(3, 4, 1), std::get<Words>(direct.codes)(3, 24, 1));
  const FileInfo info = read_info(scratch / "a.dng");
  EXPECT_EQ(info.format, "dng");
  EXPECT_EQ(info.width, 80);
}

TEST(Dng, AFolderOfThemIsShots) {
  const ScratchDir scratch;
  for (const int k : {0, 1, 2}) {
    Mosaic mosaic = made_up_mosaic({64, 48}, Cfa::kRggb, 0, 4095, 3);
    mosaic.exposure.seconds = 0.001 * std::exp2(k);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) mosaic.codes(x, y) = static_cast<std::uint16_t>(mosaic.codes(x, y) >> (2 - k));
    }
    write_dng(scratch / ("shot_" + std::to_string(2 - k) + ".dng"), mosaic, "x");
  }
  const Bracket bracket = read_bracket({scratch.path()});
  ASSERT_EQ(bracket.shots.size(), 3u);
  EXPECT_EQ(bracket.bits(), 16);
  EXPECT_DOUBLE_EQ(*bracket.shots[2].exposure.seconds, 0.004);
}

TEST(Dng, ShutterTimesKeepThePrecisionOfExif) {
  const ScratchDir scratch;
  for (const double seconds : {1.0 / 8000, 1.0 / 3049, 0.0125, 2.5, 30.0, 1e-5}) {
    Mosaic mosaic = made_up_mosaic({32, 32}, Cfa::kRggb, 0, 255, 4);
    mosaic.exposure = {seconds, std::nullopt, std::nullopt, 0};
    write_dng(scratch / "a.dng", mosaic, "x");
    const Exposure back = read_photo_header(scratch / "a.dng").exposure;
    EXPECT_DOUBLE_EQ(back.seconds.value_or(0), seconds);
    EXPECT_FALSE(back.f_number);
    EXPECT_FALSE(back.iso);
  }
}

/// OpenImageIO's reader of raw files, told to render nothing.
TEST(Dng, AnotherReaderFindsTheSameLight) {
  const ScratchDir scratch;
  const Mosaic mosaic = made_up_mosaic({96, 64}, Cfa::kBggr, 64, 1023, 5);
  write_dng(scratch / "a.dng", mosaic, "Made-up 12");
  OIIO::ImageSpec config;
  config.attribute("raw:ColorSpace", "raw");
  config.attribute("raw:Demosaic", "DHT");
  config.attribute("raw:auto_bright", 0);
  config.attribute("raw:use_camera_wb", 0);
  config.attribute("raw:adjust_maximum_thr", 0.0f);
  const float ones[] = {1, 1, 1, 1};
  config.attribute("raw:user_mul", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 4), ones);
  const auto input = OIIO::ImageInput::open((scratch / "a.dng").string(), &config);
  ASSERT_TRUE(input) << OIIO::geterror();
  ASSERT_STREQ(input->format_name(), "raw");
  EXPECT_EQ(input->spec().width, 96);
  EXPECT_EQ(input->spec().height, 64);
  EXPECT_EQ(input->spec().get_string_attribute("Model"), "Made-up 12");
  EXPECT_FLOAT_EQ(
      input->spec().get_float_attribute("Exif:ExposureTime", input->spec().get_float_attribute("ExposureTime")),
      1.0f / 60);
  std::vector<std::uint16_t> theirs(96 * 64 * 3);
  ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT16, theirs.data()));
  const Words ours = std::move(std::get<Words>(read_photo(scratch / "a.dng").codes));
  for (int y = 8; y < 56; ++y) {
    for (int x = 8; x < 88; ++x) {
      const int c = cfa_channel(Cfa::kBggr, x, y);
      ASSERT_NEAR(theirs[static_cast<std::size_t>(3 * (96 * y + x) + c)], ours(x, y, c), 2) << x << "," << y;
    }
  }
}

TEST(Dng, SameWorkSameBytes) {
  const ScratchDir scratch;
  const Mosaic mosaic = made_up_mosaic({32, 32}, Cfa::kRggb, 0, 255, 6);
  write_dng(scratch / "a.dng", mosaic, "x");
  write_dng(scratch / "b.dng", mosaic, "x");
  EXPECT_EQ(read_text(scratch / "a.dng"), read_text(scratch / "b.dng"));
}

TEST(Dng, WhatIsNoneSaysSo) {
  const ScratchDir scratch;
  const Mosaic mosaic = made_up_mosaic({64, 64}, Cfa::kRggb, 0, 255, 7);
  EXPECT_NE(error_of([&] { write_dng(scratch / "a.tif", mosaic, "x"); }).find("write .dng"), std::string::npos);
  write_dng(scratch / "a.dng", mosaic, "x");
  std::filesystem::resize_file(scratch / "a.dng", 4000);
  EXPECT_NE(error_of([&] { read_photo(scratch / "a.dng"); }).find("a.dng"), std::string::npos);
  write_photo(scratch / "b.tif", test::made_up_photo(32, 32, 16, 1));
  std::filesystem::rename(scratch / "b.tif", scratch / "b.dng");
  EXPECT_NE(error_of([&] { read_photo(scratch / "b.dng"); }).find("b.dng"), std::string::npos);
  EXPECT_NE(error_of([&] { read_dng(scratch / "none.dng"); }).find("no such file"), std::string::npos);
}

}  // namespace
}  // namespace hdr
