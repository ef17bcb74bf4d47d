// Bytes as devices write them -> codes. Packings and colours are pinned to numbers worked out by hand from the
// standards.
#include "capture/develop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "capture/internal/unpack.h"
#include "libhdr/core/random.h"
#include "libhdr/io/demosaic.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/write.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

using Bytes = std::vector<std::uint8_t>;

Frame frame_of(Bytes bytes, FrameFormat format) {
  auto owner = std::make_shared<Bytes>(std::move(bytes));
  Frame frame;
  frame.bytes = *owner;
  frame.owner = owner;
  frame.format = format;
  frame.sequence = 7;
  frame.requested = {0.25, 1};
  return frame;
}

std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

/// Samples packed as the format says; `sample(x, y)` counts in its bits.
Bytes packed(PixelFormat pixels, Size size, std::ptrdiff_t stride, const std::function<int(int, int)>& sample) {
  Bytes bytes(static_cast<std::size_t>(stride) * static_cast<std::size_t>(size.height), 0xee);
  for (int y = 0; y < size.height; ++y) {
    std::uint8_t* row = bytes.data() + y * stride;
    if (pixels == PixelFormat::kBayer10Packed || pixels == PixelFormat::kBayer12Packed) {
      std::fill_n(row, row_bytes_of(pixels, size.width), std::uint8_t{0});
    }
    for (int x = 0; x < size.width; ++x) {
      const int value = sample(x, y);
      if (pixels == PixelFormat::kBayer10Packed) {
        row[x / 4 * 5 + x % 4] = static_cast<std::uint8_t>(value >> 2);
        row[x / 4 * 5 + 4] |= static_cast<std::uint8_t>((value & 3) << 2 * (x % 4));
      } else if (pixels == PixelFormat::kBayer12Packed) {
        row[x / 2 * 3 + x % 2] = static_cast<std::uint8_t>(value >> 4);
        row[x / 2 * 3 + 2] |= static_cast<std::uint8_t>((value & 15) << 4 * (x % 2));
      } else if (bits_of(pixels) == 8) {
        row[x] = static_cast<std::uint8_t>(value);
      } else {
        row[2 * x] = static_cast<std::uint8_t>(value & 255);
        row[2 * x + 1] = static_cast<std::uint8_t>(value >> 8);
      }
    }
  }
  return bytes;
}

TEST(Unpack, MipiPackingsAsTheStandardHasThem) {
  // [CSI2]: bytes P1[9:2] P2[9:2] P3[9:2] P4[9:2], then P4[1:0] P3[1:0] P2[1:0] P1[1:0] from the top.
  const std::uint8_t ten[] = {0x12, 0x34, 0x56, 0xff, 0b11100100};
  std::uint16_t samples[4];
  internal::unpack_row(PixelFormat::kBayer10Packed, ten, 4, samples);
  EXPECT_EQ(samples[0], 0x12 << 2 | 0);
  EXPECT_EQ(samples[1], 0x34 << 2 | 1);
  EXPECT_EQ(samples[2], 0x56 << 2 | 2);
  EXPECT_EQ(samples[3], 1023);
  // P1[11:4] P2[11:4], then P2[3:0] P1[3:0].
  const std::uint8_t twelve[] = {0xab, 0xde, 0xfc};
  internal::unpack_row(PixelFormat::kBayer12Packed, twelve, 2, samples);
  EXPECT_EQ(samples[0], 0xabc);
  EXPECT_EQ(samples[1], 0xdef);
  const std::uint8_t words[] = {0x34, 0x12};
  internal::unpack_row(PixelFormat::kGrey16, words, 1, samples);
  EXPECT_EQ(samples[0], 0x1234) << "little endian";
}

struct Rgb {
  int r, g, b;
};

Rgb colour_of(int y, int cb, int cr, bool full_range) {
  const std::uint8_t pair[] = {static_cast<std::uint8_t>(y), static_cast<std::uint8_t>(cb),
                               static_cast<std::uint8_t>(y), static_cast<std::uint8_t>(cr)};
  std::uint8_t rgb[6];
  internal::rgb_from_yuyv_row(pair, 2, full_range, rgb);
  EXPECT_EQ(rgb[0], rgb[3]);
  return {rgb[0], rgb[1], rgb[2]};
}

void expect_colour(const Rgb& is, const Rgb& wanted, const char* name) {
  EXPECT_NEAR(is.r, wanted.r, 1) << name;
  EXPECT_NEAR(is.g, wanted.g, 1) << name;
  EXPECT_NEAR(is.b, wanted.b, 1) << name;
}

TEST(Yuyv, ColourBarsComeOut) {
  // 100 % colour bars in BT.601, 8 bits, as test generators tabulate them (Y Cb Cr).
  expect_colour(colour_of(235, 128, 128, false), {255, 255, 255}, "white");
  expect_colour(colour_of(16, 128, 128, false), {0, 0, 0}, "black");
  expect_colour(colour_of(210, 16, 146, false), {255, 255, 0}, "yellow");
  expect_colour(colour_of(170, 166, 16, false), {0, 255, 255}, "cyan");
  expect_colour(colour_of(145, 54, 34, false), {0, 255, 0}, "green");
  expect_colour(colour_of(106, 202, 222, false), {255, 0, 255}, "magenta");
  expect_colour(colour_of(81, 90, 240, false), {255, 0, 0}, "red");
  expect_colour(colour_of(41, 240, 110, false), {0, 0, 255}, "blue");
  // The same in full range (JFIF).
  expect_colour(colour_of(255, 128, 128, true), {255, 255, 255}, "white");
  expect_colour(colour_of(76, 85, 255, true), {254, 0, 0}, "red");
  expect_colour(colour_of(29, 255, 107, true), {0, 0, 254}, "blue");
  expect_colour(colour_of(100, 128, 128, true), {100, 100, 100}, "grey");
  EXPECT_EQ(colour_of(250, 128, 128, false).g, 255) << "above white is clipped";
  EXPECT_EQ(colour_of(3, 128, 128, false).g, 0) << "below black is clipped";
}

TEST(Yuyv, ChromaIsInterpolatedBetweenItsSamples) {
  const std::uint8_t row[] = {128, 100, 128, 128, 128, 140, 128, 128};
  std::uint8_t rgb[12];
  internal::rgb_from_yuyv_row(row, 4, true, rgb);
  EXPECT_NEAR(rgb[2], 128 + 1.772 * (100 - 128), 1);
  EXPECT_NEAR(rgb[5], 128 + 1.772 * (120 - 128), 1) << "half-way between 100 and 140";
  EXPECT_NEAR(rgb[8], 128 + 1.772 * (140 - 128), 1);
  EXPECT_NEAR(rgb[11], 128 + 1.772 * (140 - 128), 1) << "the last one has no neighbour";
}

TEST(Develop, RowsMayBePaddedAndWidthsOdd) {
  const FrameFormat format{PixelFormat::kYuyv, Cfa::kNone, {5, 3}, 32, true, 0, 255};
  Bytes bytes(32 * 3, 0xee);
  for (int y = 0; y < 3; ++y) {
    for (int pair = 0; pair < 3; ++pair) {
      const std::uint8_t block[] = {static_cast<std::uint8_t>(10 * y + 2 * pair), 128,
                                    static_cast<std::uint8_t>(10 * y + 2 * pair + 1), 128};
      std::copy_n(block, 4, bytes.begin() + 32 * y + 4 * pair);
    }
  }
  const Photo photo = develop(frame_of(bytes, format));
  EXPECT_TRUE(photo.lossy) << "chroma is subsampled";
  EXPECT_EQ(photo.bits, 8);
  const auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) EXPECT_EQ(codes(x, y, 1), 10 * y + x);
  }
}

TEST(Develop, EveryBayerLayoutHoldsTheSameMosaic) {
  const Size size{38, 30};
  Random random(5, 0);
  std::vector<double> levels;
  for (int k = 0; k < size.width * size.height; ++k) levels.push_back(random.uniform());
  for (const PixelFormat pixels : {PixelFormat::kBayer8, PixelFormat::kBayer10, PixelFormat::kBayer12,
                                   PixelFormat::kBayer16, PixelFormat::kBayer10Packed, PixelFormat::kBayer12Packed}) {
    for (const std::ptrdiff_t padding : {0, 2, 26}) {
      const int most = (1 << bits_of(pixels)) - 1;
      const std::ptrdiff_t stride = row_bytes_of(pixels, size.width) + padding;
      const FrameFormat format{pixels, Cfa::kGrbg, size, stride, false, most / 16.0, 1.0 * most};
      const auto sample = [&](int x, int y) {
        return static_cast<int>(std::lround(most * levels[static_cast<std::size_t>(y * size.width + x)]));
      };
      const Frame frame = frame_of(packed(pixels, size, stride, sample), format);
      const Mosaic mosaic = mosaic_from(frame);
      EXPECT_EQ(mosaic.cfa, Cfa::kGrbg);
      EXPECT_EQ(mosaic.white_level, most);
      EXPECT_EQ(mosaic.black(3, 2), most / 16.0);
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          ASSERT_EQ(mosaic.codes(x, y), sample(x, y)) << to_text(format) << " at " << x << "," << y;
        }
      }
      const Photo photo = develop(frame);
      EXPECT_EQ(photo.bits, 16);
      EXPECT_TRUE(is_linear(frame.format));
      const auto& codes = std::get<Image<std::uint16_t>>(photo.codes);
      const double share = std::clamp((sample(5, 7) - most / 16.0) / (most - most / 16.0), 0.0, 1.0);
      EXPECT_NEAR(codes(5, 7, cfa_channel(Cfa::kGrbg, 5, 7)), 65535 * share, 0.51);
    }
  }
}

TEST(Develop, DeepGreyAndRgbHaveBlackAtZeroAndWhiteAtFullScale) {
  const Size size{4, 2};
  const FrameFormat grey{PixelFormat::kGrey12, Cfa::kNone, size, 8, false, 256, 3840};
  const auto codes_at = [&](int x, int) { return std::array{100, 256, 2048, 4000}[static_cast<std::size_t>(x)]; };
  const Photo photo = develop(frame_of(packed(PixelFormat::kGrey12, size, 8, codes_at), grey));
  EXPECT_EQ(photo.bits, 16);
  EXPECT_FALSE(is_linear(grey)) << "nobody says that a camera's grey is linear";
  const auto& codes = std::get<Image<std::uint16_t>>(photo.codes);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(codes(0, 0, c), 0) << "below black";
    EXPECT_EQ(codes(1, 0, c), 0);
    EXPECT_EQ(codes(2, 1, c), std::lround(65535.0 * (2048 - 256) / (3840 - 256)));
    EXPECT_EQ(codes(3, 1, c), 65535) << "above white";
  }
  const FrameFormat rgb{PixelFormat::kRgb16, Cfa::kNone, {1, 1}, 6, false, 0, 65535};
  const Photo deep = develop(frame_of({1, 2, 3, 4, 5, 6}, rgb));
  EXPECT_EQ(std::get<Image<std::uint16_t>>(deep.codes)(0, 0, 1), 0x0403);
  const FrameFormat eight{PixelFormat::kRgb8, Cfa::kNone, {1, 1}, 3, false, 0, 255};
  EXPECT_EQ(std::get<Image<std::uint8_t>>(develop(frame_of({9, 8, 7}, eight)).codes)(0, 0, 2), 7);
}

TEST(Develop, MotionJpegIsDecodedFromMemory) {
  const test::ScratchDir scratch;
  Photo made;
  made.codes = Image<std::uint8_t>(48, 32, 3);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 48; ++x)
      std::fill_n(std::get<Image<std::uint8_t>>(made.codes).pixel(x, y), 3, static_cast<std::uint8_t>(40 + 3 * x));
  }
  write_photo(scratch / "a.jpg", made, 95);
  const std::string jpeg = read_text(scratch / "a.jpg");
  const FrameFormat format{PixelFormat::kMjpeg, Cfa::kNone, {48, 32}, 0, true, 0, 255};
  const Photo photo = develop(frame_of(Bytes(jpeg.begin(), jpeg.end()), format), {std::nullopt, 100.0});
  EXPECT_TRUE(photo.lossy);
  EXPECT_EQ(photo.size(), (Size{48, 32}));
  EXPECT_NEAR(std::get<Image<std::uint8_t>>(photo.codes)(20, 10, 1), 100, 3);
  EXPECT_EQ(photo.exposure.seconds, 0.25);
  EXPECT_NE(
      error_of([&] { develop(frame_of(Bytes(jpeg.begin(), jpeg.begin() + 300), format)); }).find("frame 7: truncated"),
      std::string::npos);
}

TEST(Develop, TheExposureIsTheVerifiedOne) {
  const FrameFormat format{PixelFormat::kGrey8, Cfa::kNone, {1, 1}, 1, false, 0, 255};
  Frame frame = frame_of({9}, format);
  frame.requested = {0.5, 1};
  EXPECT_EQ(develop(frame).exposure.seconds, 0.5);
  frame.exposure = ExposureSetting{0.48, 2};
  const Exposure known = develop(frame, {2.8, 100.0}).exposure;
  EXPECT_EQ(known.seconds, 0.48);
  EXPECT_EQ(known.f_number, 2.8);
  EXPECT_EQ(known.iso, 200) << "gain 2 at ISO 100";
}

TEST(Develop, ShortFramesAndImpossibleFormatsAreRefused) {
  for (const PixelFormat pixels :
       {PixelFormat::kGrey8, PixelFormat::kYuyv, PixelFormat::kRgb16, PixelFormat::kBayer10Packed}) {
    const Size size{20, 20};
    const std::ptrdiff_t row = row_bytes_of(pixels, size.width);
    FrameFormat format{pixels, Cfa::kRggb, size, row, false, 0, 255};
    const auto bytes = static_cast<std::size_t>(20 * row);
    EXPECT_NO_THROW(develop(frame_of(Bytes(bytes), format)));
    EXPECT_NE(error_of([&] { develop(frame_of(Bytes(bytes - 1), format)); }).find("short"), std::string::npos);
    format.stride_bytes = row - 1;
    EXPECT_NE(error_of([&] { develop(frame_of(Bytes(bytes), format)); }).find("rows of"), std::string::npos);
  }
  const FrameFormat grey{PixelFormat::kGrey8, Cfa::kNone, {20, 20}, 20, false, 0, 255};
  EXPECT_NE(error_of([&] { mosaic_from(frame_of(Bytes(400), grey)); }).find("not a sensor's mosaic"),
            std::string::npos);
}

}  // namespace
}  // namespace hdr
