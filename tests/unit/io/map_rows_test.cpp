// A map written as its bands come is the file that it would be when written whole.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "libhdr/core/parallel.h"
#include "libhdr/io/internal/half_rows.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::ScratchDir;

RadianceMap made_up_map(int width, int height) {
  RadianceMap map;
  map.rgb = test::test_scene(width, height, 16, 3);
  map.stddev = Image<float>(map.size(), 3);
  for (int y = 0; y < height; ++y) {
    for (int i = 0; i < 3 * width; ++i) map.stddev.row(y)[i] = 0.01f * map.rgb.row(y)[i];
  }
  map.white_luminance = 120.0;
  map.projection = "mirror-ball ball=10,10,8";
  return map;
}

MapHeader header_of(const RadianceMap& map) {
  return {map.size(), map.chromaticities, map.white_luminance, map.projection, !map.stddev.empty(), false};
}

/// Bands of 1 to 40 rows.
void put_in_bands(MapWriter& writer, const RadianceMap& map, std::uint64_t seed, int until) {
  Random random(seed, 0);
  for (int first = 0; first < until;) {
    const int last = std::min(until, first + 1 + static_cast<int>(random.bits() % 40));
    writer.put({first,
                map.rgb.view().rows(first, last),
                map.stddev.empty() ? View<const float>() : map.stddev.view().rows(first, last),
                {}});
    first = last;
  }
}

TEST(MapRows, BandsGiveTheBytesOfTheWholeMap) {
  const ScratchDir scratch;
  const RadianceMap map = made_up_map(70, 523);
  Provenance provenance;
  provenance.add("exposure_unit", "0.25");
  const auto expect_same = [&](const std::string& name, const WriteOptions& options) {
    write_map(scratch / ("whole" + name), map, provenance, options);
    const std::string whole = read_text(scratch / ("whole" + name));
    for (const int threads_used : {1, 3}) {
      set_threads(threads_used);
      const auto writer = open_map_rows(scratch / ("bands" + name), header_of(map), provenance, options);
      put_in_bands(*writer, map, static_cast<std::uint64_t>(threads_used), map.rgb.height());
      EXPECT_FALSE(fs::exists(scratch / ("bands" + name))) << "half of a file in place";
      writer->finish();
      EXPECT_TRUE(read_text(scratch / ("bands" + name)) == whole)
          << name << ", " << options.compression << ", threads: " << threads_used;
      fs::remove(scratch / ("bands" + name));
    }
    set_threads(0);
  };
  for (const char* compression : {"none", "rle", "zips", "zip", "piz", "pxr24", "dwaa", "dwab"}) {
    for (const SampleType type : {SampleType::kHalf, SampleType::kFloat}) expect_same(".exr", {type, compression});
  }
  expect_same(".hdr", {});
  expect_same(".tif", {});
}

TEST(MapRows, FlagsBecomeALayerOfZerosAndOnes) {
  const ScratchDir scratch;
  const RadianceMap map = made_up_map(19, 37);
  MapHeader header = header_of(map);
  header.stddev = false;
  header.flags = true;
  Image<std::uint8_t> flags(map.size(), 1);
  for (int y = 0; y < 37; ++y) {
    for (int x = 0; x < 19; ++x) flags(x, y) = static_cast<std::uint8_t>((x + 2 * y) % 4);
  }
  const auto writer = open_map_rows(scratch / "a.exr", header, {}, {SampleType::kFloat, "piz"});
  writer->put({0, map.rgb.view().rows(0, 20), {}, flags.view().rows(0, 20)});
  writer->put({20, map.rgb.view().rows(20, 37), {}, flags.view().rows(20, 37)});
  writer->finish();
  const auto in = OIIO::ImageInput::open((scratch / "a.exr").string());
  const std::vector<std::string>& names = in->spec().channelnames;
  EXPECT_EQ(names, (std::vector<std::string>{"R", "G", "B", "mask.clipped", "mask.dark"}));
  std::vector<float> samples(19 * 37 * 5);
  ASSERT_TRUE(in->read_image(0, 0, 0, 5, OIIO::TypeDesc::FLOAT, samples.data()));
  for (int y = 0; y < 37; ++y) {
    for (int x = 0; x < 19; ++x) {
      const float* pixel = &samples[static_cast<std::size_t>(y * 19 + x) * 5];
      ASSERT_EQ(pixel[0], map.rgb(x, y, 0));
      ASSERT_EQ(pixel[3], flags(x, y) & kClippedFlag ? 1 : 0);
      ASSERT_EQ(pixel[4], flags(x, y) & kDarkFlag ? 1 : 0);
    }
  }
  EXPECT_EQ(read_map(scratch / "a.exr").warnings, std::vector<std::string>{}) << "a map as any other";
}

TEST(MapRows, WhatIsNotFinishedLeavesNothing) {
  const ScratchDir scratch;
  const RadianceMap map = made_up_map(60, 300);
  for (const char* name : {"a.exr", "a.hdr", "a.tif"}) {
    write_text(scratch / name, "what was there before");
    {
      const auto writer = open_map_rows(scratch / name, header_of(map));
      put_in_bands(*writer, map, 5, 290);
    }
    EXPECT_EQ(read_text(scratch / name), "what was there before");
    fs::remove(scratch / name);
    EXPECT_TRUE(fs::is_empty(scratch.path())) << name;
  }
}

TEST(MapRows, HalfOverflowIsCountedOverAllBands) {
  const ScratchDir scratch;
  RadianceMap map = made_up_map(60, 300);
  map.rgb(3, 4, 0) = 1e6f;
  map.rgb(3, 4, 1) = 65520.f;
  map.rgb(59, 299, 2) = 2e7f;
  const std::string message = error_of([&] {
    const auto writer = open_map_rows(scratch / "a.exr", header_of(map));
    put_in_bands(*writer, map, 6, 300);
    writer->finish();
  });
  EXPECT_EQ(message, (scratch / "a.exr").string() +
                         ": cannot be written: 2 pixels exceed the largest half, 65504 (the largest is 2e+07); pass "
                         "--type float");
  EXPECT_TRUE(fs::is_empty(scratch.path()));
  EXPECT_EQ(error_of([&] { write_map(scratch / "a.exr", map); }), message) << "written whole, it says the same";
}

/// IEEE 754 binary16, positive and finite.
double value_of_half(int code) {
  const int exponent = code >> 10, mantissa = code & 1023;
  return exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
}

TEST(MapRows, HalvesAreRoundedAlikeWithAndWithoutTheInstruction) {
  std::vector<float> values;
  Random random(8, 0);
  for (int k = 0; k < 100000; ++k) {
    const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits()));
    if (!std::isnan(value)) values.push_back(value);
  }
  // Half-way between halves, exactly and by a hair; and where halves are subnormal.
  for (int code = 0; code < 0x7c00; ++code) {
    const double low = value_of_half(code), high = value_of_half(code + 1);
    const auto middle = static_cast<float>(0.5 * (low + high));
    for (const float value :
         {static_cast<float>(low), middle, std::nextafter(middle, 0.f), std::nextafter(middle, 1e9f)}) {
      values.push_back(value);
    }
  }
  std::vector<std::uint16_t> fast(values.size()), portable(values.size());
  internal::halves_from_floats(values.data(), fast.data(), values.size());
  internal::halves_from_floats_portably(values.data(), portable.data(), values.size());
  for (std::size_t k = 0; k < values.size(); ++k) ASSERT_EQ(fast[k], portable[k]) << values[k];
  for (int code = 0; code < 0x7c00; code += 7) {
    const auto exact = static_cast<float>(value_of_half(code));
    std::uint16_t bits = 0;
    internal::halves_from_floats_portably(&exact, &bits, 1);
    ASSERT_EQ(bits, code) << exact;
  }
}

}  // namespace
}  // namespace hdr
