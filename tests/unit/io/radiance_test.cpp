// Radiance pictures: every form of header and scanline, against the definition and OpenImageIO.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>

#include "libhdr/io/internal/rgbe.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

using internal::Rgbe;
using test::differing_samples;
using test::error_of;
using test::ScratchDir;

const std::string kStart = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";

std::string text_of(const Rgbe& code) {
  return std::string(reinterpret_cast<const char*>(code.data()), 4);
}

/// A code whose red mantissa tells its place.
Rgbe code_at(int x, int y) {
  return {static_cast<std::uint8_t>(128 + 16 * y + x), 70, 60, 129};
}

TEST(Rgbe, EncodesAndDecodesWithinHalfAStepOfTheLargest) {
  Random random(1, 0);
  for (int i = 0; i < 20000; ++i) {
    float rgb[3];
    for (float& v : rgb) v = static_cast<float>(std::exp2(random.normal() * 20));
    const Rgbe code = internal::rgbe_from_rgb(rgb);
    const double largest = std::max({rgb[0], rgb[1], rgb[2]});
    EXPECT_GE(*std::max_element(code.begin(), code.begin() + 3), 128) << "the largest mantissa uses its 8 bits";
    for (int c = 0; c < 3; ++c) {
      EXPECT_LE(std::abs(code[static_cast<std::size_t>(c)] * internal::rgbe_scale(code[3]) - rgb[c]), largest / 256);
    }
  }
  const float one[3] = {1, 0.5f, 0.25f};
  EXPECT_EQ(internal::rgbe_from_rgb(one), (Rgbe{128, 64, 32, 129})) << "1 = 128 2^(129-136)";
  const float nothing[3] = {9e-33f, 0, 0}, hardly[3] = {2e-32f, 0, 0}, negative[3] = {1, -1, 0};
  EXPECT_EQ(internal::rgbe_from_rgb(nothing), (Rgbe{})) << "below 1e-32";
  EXPECT_GT(internal::rgbe_from_rgb(hardly)[3], 0);
  EXPECT_EQ(internal::rgbe_from_rgb(negative)[1], 0);
  const float almost[3] = {255.9f / 256, 0, 0};
  EXPECT_EQ(internal::rgbe_from_rgb(almost), (Rgbe{128, 0, 0, 129})) << "rounds up into the next exponent";
}

TEST(Radiance, AllEightOrientationsAreThePicture) {
  const ScratchDir scratch;
  constexpr int kWidth = 3, kHeight = 2;
  for (const bool rows_first : {true, false}) {
    for (const bool y_down : {true, false}) {
      for (const bool x_right : {true, false}) {
        const std::string y_form = (y_down ? "-Y " : "+Y ") + std::to_string(kHeight);
        const std::string x_form = (x_right ? "+X " : "-X ") + std::to_string(kWidth);
        const std::string form = rows_first ? y_form + " " + x_form : x_form + " " + y_form;
        std::string bytes = kStart + form + "\n";
        for (int slow = 0; slow < (rows_first ? kHeight : kWidth); ++slow) {
          for (int fast = 0; fast < (rows_first ? kWidth : kHeight); ++fast) {
            const int x = rows_first ? fast : slow, y = rows_first ? slow : fast;
            bytes += text_of(code_at(x_right ? x : kWidth - 1 - x, y_down ? y : kHeight - 1 - y));
          }
        }
        write_text(scratch / "a.hdr", bytes);
        const RadianceMap map = read_map(scratch / "a.hdr").map;
        ASSERT_EQ(map.size(), (Size{kWidth, kHeight})) << form;
        for (int y = 0; y < kHeight; ++y) {
          for (int x = 0; x < kWidth; ++x)
            EXPECT_EQ(map.rgb(x, y, 0) * 128, code_at(x, y)[0]) << form << " " << x << "," << y;
        }
      }
    }
  }
}

/// Ten pixels, then five alike, then 300 alike: what each encoding makes of them.
struct Encoded {
  static constexpr int kWidth = 315;
  std::string flat, old_runs, new_runs;
  Encoded() {
    std::vector<Rgbe> codes;
    for (int x = 0; x < 10; ++x) codes.push_back(code_at(x, 0));
    codes.insert(codes.end(), 5, Rgbe{200, 2, 3, 130});
    codes.insert(codes.end(), 300, Rgbe{9, 250, 1, 127});
    for (const Rgbe& code : codes) flat += text_of(code);
    old_runs = flat.substr(0, 44) + std::string("\1\1\1\4", 4) + flat.substr(60, 4);
    old_runs += std::string("\1\1\1\x2b\1\1\1\1", 8);  // 43 + 256 = 299 more
    new_runs = std::string("\2\2\1\x3b", 4);
    for (std::size_t c = 0; c < 4; ++c) {
      new_runs += '\x0a';
      for (std::size_t x = 0; x < 10; ++x) new_runs += static_cast<char>(codes[x][c]);
      const auto run = [&](int count, std::size_t x) {
        new_runs += static_cast<char>(128 + count);
        new_runs += static_cast<char>(codes[x][c]);
      };
      run(5, 10);
      run(127, 15);
      run(127, 15);
      run(46, 15);
    }
  }
};

TEST(Radiance, FlatOldAndNewEncodingsAreOnePicture) {
  const ScratchDir scratch;
  const Encoded encoded;
  const std::string size = "-Y 2 +X 315\n";
  write_text(scratch / "flat.hdr", kStart + size + encoded.flat + encoded.flat);
  write_text(scratch / "mixed.hdr", kStart + size + encoded.old_runs + encoded.new_runs);
  const RadianceMap flat = read_map(scratch / "flat.hdr").map, mixed = read_map(scratch / "mixed.hdr").map;
  EXPECT_EQ(flat.rgb(0, 1, 0) * 128, 128);
  EXPECT_EQ(flat.rgb(314, 1, 1), 250 * 0x1p-9f);
  EXPECT_EQ(differing_samples(flat.rgb, mixed.rgb), 0);
}

TEST(Radiance, OpenImageIoReadsWhatWeWriteAndTheSameAsWe) {
  const ScratchDir scratch;
  for (const int width : {1, 7, 8, 129, 1000, 33000}) {
    RadianceMap map;
    map.rgb = test::test_scene(width, 5, 16, 2);
    for (int x = width / 3; x < width / 2; ++x) std::fill_n(map.rgb.pixel(x, 2), 3, 0.5f);  // runs
    write_map(scratch / "a.hdr", map);
    const RadianceMap ours = read_map(scratch / "a.hdr").map;
    const auto input = OIIO::ImageInput::open((scratch / "a.hdr").string());
    ASSERT_TRUE(input) << OIIO::geterror();
    Image<float> theirs(width, 5, 3);
    for (int y = 0; y < 5; ++y) ASSERT_TRUE(input->read_scanline(y, 0, OIIO::TypeDesc::FLOAT, theirs.row(y)));
    EXPECT_EQ(differing_samples(ours.rgb, theirs), 0) << width;
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < width; ++x) {
        const float* p = map.rgb.pixel(x, y);
        for (int c = 0; c < 3; ++c) {
          ASSERT_LE(std::abs(double{ours.rgb(x, y, c)} - p[c]), std::max({p[0], p[1], p[2]}) / 256.0);
        }
      }
    }
  }
}

TEST(Radiance, HeadersSayExposureColourAndPrimaries) {
  const ScratchDir scratch;
  const std::string pixel = text_of({128, 128, 128, 129});  // 1 1 1
  const auto first_pixel = [&](const std::string& lines, ReadMapOptions options = {}) {
    write_text(scratch / "a.hdr", "#?RGBE\n# a comment: FORMAT=nonsense\n" + lines + "\n-Y 1 +X 1\n" + pixel);
    const RadianceMap map = read_map(scratch / "a.hdr", options).map;
    return std::array{map.rgb(0, 0, 0), map.rgb(0, 0, 1), map.rgb(0, 0, 2)};
  };
  EXPECT_EQ(first_pixel(""), (std::array{1.f, 1.f, 1.f})) << "without FORMAT it is RGBE";
  EXPECT_EQ(first_pixel("EXPOSURE=2\nVIEW= -vtv\nEXPOSURE= 4\n"), (std::array{.125f, .125f, .125f}));
  EXPECT_EQ(first_pixel("COLORCORR= 2 1 0.5\nEXPOSURE=2\n"), (std::array{.25f, .5f, 1.f}));
  const std::array half_more = first_pixel("", {.mantissa = Mantissa::kMiddle});
  EXPECT_EQ(half_more[0], 128.5f / 128);
  // XYZE of (1,1,1) is the white of equal energy, in Rec. 709: the inverse of its matrix, times (1,1,1).
  const std::array xyz = first_pixel("FORMAT=32-bit_rle_xyze\n");
  EXPECT_NEAR(xyz[0], 1.2048, 5e-4);
  EXPECT_NEAR(xyz[1], 0.9483, 5e-4);
  EXPECT_NEAR(xyz[2], 0.9089, 5e-4);
  const std::array radiance = first_pixel("PRIMARIES= .64 .33 .29 .6 .15 .06 .3333 .3333\n");
  EXPECT_NEAR(radiance[0], xyz[0], 1e-3) << "Radiance's own white is that of equal energy too";
  EXPECT_NEAR(radiance[2], xyz[2], 1e-3);
  EXPECT_EQ(first_pixel("PRIMARIES= .64 .33 .29 .6 .15 .06 .3333 .3333\n", {.primaries = Primaries::kAsInFile})[0],
            1.f);
}

TEST(Radiance, WhatWeWriteKeepsItsPlaceOnTheSphereItsUnitAndItsPrimaries) {
  const ScratchDir scratch;
  RadianceMap map;
  map.rgb = test::test_scene(16, 8, 4, 3);
  map.projection = "mirror-ball cx=8 cy=4 r=3.5";
  map.white_luminance = 179.25;
  map.chromaticities = {{0.7f, 0.29f}, {0.17f, 0.79f}, {0.13f, 0.05f}, {0.31f, 0.32f}};
  write_map(scratch / "a.hdr", map);
  const RadianceMap back = read_map(scratch / "a.hdr", {.primaries = Primaries::kAsInFile}).map;
  EXPECT_EQ(back.projection, map.projection);
  EXPECT_EQ(back.white_luminance, 179.25);
  EXPECT_EQ(back.chromaticities.green[1], 0.79f);
}

TEST(Radiance, DamageIsSaidWithItsPlace) {
  const ScratchDir scratch;
  const Encoded encoded;
  const auto message = [&](const std::string& bytes) {
    write_text(scratch / "a.hdr", bytes);
    return error_of([&] { read_map(scratch / "a.hdr"); });
  };
  const std::string two = kStart + "-Y 2 +X 315\n" + encoded.new_runs;
  EXPECT_NE(message(two).find("after row 1 of 2: the file ends there"), std::string::npos) << message(two);
  std::string other_length = two + encoded.new_runs;
  other_length[two.size() + 3] = '\x3c';
  EXPECT_NE(message(other_length).find("after row 1 of 2: a scanline of another length"), std::string::npos);
  std::string long_run = two + encoded.new_runs;
  long_run[two.size() + 4] = '\xff';
  long_run.replace(two.size() + 6, 4, "\xff\1\xff\1");
  EXPECT_NE(message(long_run).find("a run beyond the end"), std::string::npos) << message(long_run);
  EXPECT_NE(message(kStart + "-Y 1 +X 4\n\1\1\1\4" + std::string(16, 'x')).find("repeats no pixel"), std::string::npos);
  EXPECT_NE(message(kStart + "-Y 0 +X 4\n").find("no resolution"), std::string::npos);
  EXPECT_NE(message(kStart + "-Y 1 -Y 4\n").find("no resolution"), std::string::npos);
  EXPECT_NE(message("#?RADIANCE\nEXPOSURE=1\n").find("header has no end"), std::string::npos);
  EXPECT_NE(message("#?RADIANCE\nFORMAT=ascii\n\n-Y 1 +X 1\n0000").find("FORMAT=ascii"), std::string::npos);
  EXPECT_NE(message(kStart + "-Y 1000000 +X 1000000\n" + encoded.flat).find("promises"), std::string::npos);
}

}  // namespace
}  // namespace hdr
