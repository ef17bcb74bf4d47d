// Radiance maps out and in again, and what other programs write.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libhdr/core/color.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

using test::differing_samples;
using test::error_of;
using test::ScratchDir;

RadianceMap made_up_map(int width = 37, int height = 23) {
  RadianceMap map;
  map.rgb = test::test_scene(width, height, 12, 1);
  return map;
}

double worst_relative_difference(const Image<float>& a, const Image<float>& b) {
  double worst = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (std::size_t i = 0; i < a.row_samples(); ++i) {
      worst = std::max(worst, std::abs(double{a.row(y)[i]} - b.row(y)[i]) / a.row(y)[i]);
    }
  }
  return worst;
}

TEST(Map, FloatExrKeepsEveryBitAndEverythingSaid) {
  const ScratchDir scratch;
  RadianceMap map = made_up_map();
  map.alpha = Image<float>(map.size(), 1);
  map.stddev = test::test_scene(map.size().width, map.size().height, 4, 2);
  for (int y = 0; y < map.size().height; ++y) std::fill_n(map.alpha.row(y), map.size().width, 0.25f * (y % 5));
  map.chromaticities = {{0.7f, 0.29f}, {0.17f, 0.79f}, {0.13f, 0.05f}, {0.31f, 0.32f}};
  map.white_luminance = 179;
  map.projection = "mirror-ball cx=10.5 cy=11 r=9";
  Provenance provenance;
  provenance.add("inputs", "a.jpg b.jpg");
  write_map(scratch / "a.exr", map, provenance, {SampleType::kFloat, "zip"});

  const ReadMap back = read_map(scratch / "a.exr", {.primaries = Primaries::kAsInFile});
  EXPECT_TRUE(back.warnings.empty());
  EXPECT_EQ(differing_samples(map.rgb, back.map.rgb), 0);
  EXPECT_EQ(differing_samples(map.alpha, back.map.alpha), 0);
  EXPECT_EQ(differing_samples(map.stddev, back.map.stddev), 0);
  EXPECT_EQ(back.map.chromaticities.red[0], 0.7f);
  EXPECT_EQ(back.map.chromaticities.white[1], 0.32f);
  EXPECT_EQ(back.map.white_luminance, 179);
  EXPECT_EQ(back.map.projection, map.projection);

  const auto input = OIIO::ImageInput::open((scratch / "a.exr").string());
  const OIIO::ImageSpec& spec = input->spec();
  EXPECT_EQ(spec.get_string_attribute("hdr:inputs"), "a.jpg b.jpg");
  EXPECT_NE(spec.get_string_attribute("hdr:version"), "");
  EXPECT_EQ(spec.get_string_attribute("compression"), "zip");
  EXPECT_EQ(spec.get_string_attribute("textureformat"), "") << "a mirror ball is no OpenEXR envmap";
  EXPECT_FALSE(spec.find_attribute("DateTime") || spec.find_attribute("capDate") || spec.find_attribute("Software"));
}

TEST(Map, HalfExrIsTheDefaultWithinHalfAnUlp) {
  const ScratchDir scratch;
  const RadianceMap map = made_up_map();
  write_map(scratch / "a.exr", map);
  EXPECT_LE(worst_relative_difference(map.rgb, read_map(scratch / "a.exr").map.rgb), 0x1p-11) << "11 bits of mantissa";
  const FileInfo info = read_info(scratch / "a.exr");
  EXPECT_EQ(info.type, "half");
  EXPECT_EQ(info.compression, "piz");
}

TEST(Map, EveryCompressionCanBeRead) {
  const ScratchDir scratch;
  const RadianceMap map = made_up_map();
  for (const char* name : {"none", "rle", "zip", "zips", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}) {
    write_map(scratch / "a.exr", map, {}, {SampleType::kHalf, name});
    EXPECT_EQ(read_map(scratch / "a.exr").map.size(), map.size()) << name;
    EXPECT_EQ(read_info(scratch / "a.exr").compression.substr(0, 4), std::string(name).substr(0, 4));
  }
  const std::string message = error_of([&] { write_map(scratch / "b.exr", map, {}, {SampleType::kHalf, "lzw"}); });
  EXPECT_NE(message.find("one of none, rle, zips, zip, piz"), std::string::npos) << message;
  EXPECT_FALSE(std::filesystem::exists(scratch / "b.exr"));
}

TEST(Map, SameMapSameBytes) {
  const ScratchDir scratch;
  const RadianceMap map = made_up_map();
  for (const std::string extension : {".exr", ".hdr", ".tif"}) {
    write_map(scratch / ("a" + extension), map);
    write_map(scratch / ("b" + extension), map);
    EXPECT_EQ(read_text(scratch / ("a" + extension)), read_text(scratch / ("b" + extension))) << extension;
    EXPECT_FALSE(OIIO::ImageInput::open((scratch / ("a" + extension)).string())->spec().find_attribute("DateTime"))
        << extension << ": a clock time agrees by luck within one second";
  }
}

TEST(Map, HalfOverflowCountsItsPixelsAndNamesTheRemedy) {
  const ScratchDir scratch;
  RadianceMap map = made_up_map();
  map.rgb(3, 4, 0) = map.rgb(3, 4, 1) = 1e6f;
  map.rgb(5, 6, 2) = 65505.f;
  map.rgb(7, 8, 2) = 65504.f;
  const std::string message = error_of([&] { write_map(scratch / "a.exr", map); });
  EXPECT_NE(message.find("2 pixels"), std::string::npos) << message;
  EXPECT_NE(message.find("--type float"), std::string::npos) << message;
  EXPECT_FALSE(std::filesystem::exists(scratch / "a.exr"));
  write_map(scratch / "a.exr", map, {}, {SampleType::kFloat, "piz"});
  EXPECT_EQ(read_map(scratch / "a.exr").map.rgb(3, 4, 0), 1e6f);
}

TEST(Map, RadianceFilesRoundToTheNearestMantissa) {
  const ScratchDir scratch;
  const RadianceMap map = made_up_map(301, 200);
  write_map(scratch / "a.hdr", map);
  const RadianceMap back = read_map(scratch / "a.hdr").map;
  double bias = 0, worst = 0;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 301; ++x) {
      const float* p = map.rgb.pixel(x, y);
      const double largest = std::max({p[0], p[1], p[2]});
      for (int c = 0; c < 3; ++c) {
        const double error = (back.rgb(x, y, c) - p[c]) / largest;
        bias += error / (301 * 200 * 3);
        worst = std::max(worst, std::abs(error));
      }
    }
  }
  EXPECT_LE(worst, 0.5 / 128 + 1e-6) << "half a step of an 8-bit mantissa, which is 128 to 255";
  EXPECT_LE(std::abs(bias), 2e-5) << "cutting instead of rounding would lose 0.0027 on average";
}

TEST(Map, ExposureLinesOfRadianceFilesMultiply) {
  const ScratchDir scratch;
  // Mantissa 128 with exponent 129 is 128 * 2^(129-136) = 1.
  const std::string pixels = std::string("\x80\x40\x20\x81", 4);
  write_text(scratch / "a.hdr",
             "#?RADIANCE\nEXPOSURE=2\nEXPOSURE= 4\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + pixels + pixels);
  const RadianceMap map = read_map(scratch / "a.hdr").map;
  EXPECT_FLOAT_EQ(map.rgb(0, 0, 0), 1.0f / 8);
  EXPECT_FLOAT_EQ(map.rgb(1, 0, 1), 0.5f / 8);
  EXPECT_DOUBLE_EQ(read_info(scratch / "a.hdr").max, 1.0 / 8);
}

TEST(Map, PfmRowsRunUpwards) {
  const ScratchDir scratch;
  for (const bool little : {true, false}) {
    std::string bytes = std::string("PF\n1 2\n") + (little ? "-1.0\n" : "1.0\n");
    for (const float v : {1.f, 2.f, 3.f, 4.f, 5.f, 6.f}) {  // the bottom row comes first
      char raw[4];
      std::memcpy(raw, &v, 4);
      if (!little) std::reverse(raw, raw + 4);
      bytes.append(raw, 4);
    }
    write_text(scratch / "a.pfm", bytes);
    const RadianceMap map = read_map(scratch / "a.pfm").map;
    EXPECT_EQ(map.rgb(0, 1, 0), 1.f) << "negative scale: little endian = " << little;
    EXPECT_EQ(map.rgb(0, 0, 2), 6.f);
  }
}

TEST(Map, FloatTiffIsLinear) {
  const ScratchDir scratch;
  const RadianceMap map = made_up_map();
  write_map(scratch / "a.tif", map);
  const ReadMap back = read_map(scratch / "a.tif");
  EXPECT_EQ(differing_samples(map.rgb, back.map.rgb), 0);
  EXPECT_TRUE(back.warnings.empty());
}

TEST(Map, IntegerFilesAreSrgbAndSaySo) {
  const ScratchDir scratch;
  Image<std::uint8_t> codes(2, 1, 4);
  const std::uint8_t values[8] = {255, 128, 0, 255, 255, 128, 0, 51};
  std::copy_n(values, 8, codes.row(0));
  write_picture(scratch / "a.png", codes);
  const ReadMap back = read_map(scratch / "a.png");
  ASSERT_EQ(back.warnings.size(), 1u);
  EXPECT_NE(back.warnings[0].find("taken as sRGB"), std::string::npos);
  EXPECT_FLOAT_EQ(back.map.rgb(0, 0, 0), 1);
  EXPECT_NEAR(back.map.rgb(0, 0, 1), linear_from_srgb(128 / 255.0), 1e-6);
  EXPECT_FLOAT_EQ(back.map.alpha(1, 0), 0.2f);
  EXPECT_NEAR(back.map.rgb(1, 0, 1), 0.2 * linear_from_srgb(128 / 255.0), 1e-6) << "alpha multiplied in, as in EXR";
}

TEST(Map, PicturesAndUnknownFormatsAreRefused) {
  const ScratchDir scratch;
  const RadianceMap map = made_up_map();
  for (const char* name : {"a.png", "a.jpg", "a.JPEG"}) {
    EXPECT_NE(error_of([&] { write_map(scratch / name, map); }).find("tonemap"), std::string::npos) << name;
  }
  EXPECT_NE(error_of([&] { write_map(scratch / "a.xyz", map); }).find("'.xyz'"), std::string::npos);
  const std::string missing = error_of([&] { write_map(scratch / "no/a.exr", map); });
  EXPECT_TRUE(missing.starts_with((scratch / "no/a.exr").string() + ": cannot be written: ")) << missing;
}

// ---- EXR as others write it ----

void write_with_oiio(const Path& path, const OIIO::ImageSpec& spec, const std::vector<float>& samples) {
  const auto out = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(out->open(path.string(), spec) && out->write_image(OIIO::TypeDesc::FLOAT, samples.data()) && out->close())
      << out->geterror();
}

OIIO::ImageSpec float_spec(int width, int height, const std::vector<std::string>& channels) {
  OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), OIIO::TypeDesc::FLOAT);
  spec.channelnames = channels;
  return spec;
}

TEST(ForeignExr, ChannelsAreFoundByName) {
  const ScratchDir scratch;
  const Path path = scratch / "a.exr";
  write_with_oiio(path, float_spec(1, 1, {"Z", "B", "G", "R"}), {9, 3, 2, 1});
  const RadianceMap all = read_map(path).map;
  EXPECT_EQ((std::array{all.rgb(0, 0, 0), all.rgb(0, 0, 1), all.rgb(0, 0, 2)}), (std::array{1.f, 2.f, 3.f}));

  write_with_oiio(path, float_spec(1, 1, {"R", "B"}), {1, 3});
  const ReadMap two = read_map(path);
  EXPECT_EQ((std::array{two.map.rgb(0, 0, 0), two.map.rgb(0, 0, 1), two.map.rgb(0, 0, 2)}),
            (std::array{1.f, 0.f, 3.f}));
  EXPECT_EQ(two.warnings.size(), 1u);

  write_with_oiio(path, float_spec(1, 1, {"Y"}), {5});
  const ReadMap grey = read_map(path);
  EXPECT_EQ(grey.map.rgb(0, 0, 2), 5.f);
  EXPECT_NE(grey.warnings.at(0).find("luminance only"), std::string::npos);

  write_with_oiio(path, float_spec(1, 1, {"N.X", "N.Y", "N.Z"}), {1, 2, 3});
  EXPECT_NE(error_of([&] { read_map(path); }).find("a.exr: no channels R, G, B or Y among"), std::string::npos);
}

TEST(ForeignExr, OddSamplesAreMendedAndCounted) {
  const ScratchDir scratch;
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  write_with_oiio(scratch / "a.exr", float_spec(2, 2, {"R", "G", "B"}), {nan, 1, 2, -3, inf, 4, -inf, 7, 0, nan, 1, 1});
  const FileInfo info = read_info(scratch / "a.exr");
  EXPECT_EQ(info.nan, 2);
  EXPECT_EQ(info.inf, 2);
  EXPECT_EQ(info.negative, 1);
  EXPECT_EQ(info.max, 7);
  EXPECT_EQ(info.min, -3);
  EXPECT_NEAR(info.stops, std::log2(7.0), 1e-6) << "largest over smallest positive sample";
  const ReadMap mended = read_map(scratch / "a.exr");
  const Image<float>& rgb = mended.map.rgb;
  EXPECT_EQ(rgb(0, 0, 0), 0) << "NaN";
  EXPECT_EQ(rgb(1, 0, 0), 0) << "negative";
  EXPECT_EQ(rgb(1, 0, 1), 7) << "infinity becomes the largest finite sample";
  EXPECT_EQ(rgb(0, 1, 0), 0) << "minus infinity";
  EXPECT_NE(mended.warnings.at(0).find("2 NaN and 2 negative samples became 0, 1 infinite ones 7"), std::string::npos)
      << mended.warnings.at(0);
  const RadianceMap as_it_is = read_map(scratch / "a.exr", {NonFinite::kKeep}).map;
  const Image<float>& kept = as_it_is.rgb;
  EXPECT_TRUE(std::isnan(kept(0, 0, 0)) && std::isinf(kept(1, 0, 1)) && kept(1, 0, 0) == -3);
  write_with_oiio(scratch / "b.exr", float_spec(1, 1, {"R", "G", "B"}), {nan, nan, nan});
  EXPECT_NE(error_of([&] { read_map(scratch / "b.exr"); }).find("b.exr: all samples are NaN, infinite or negative"),
            std::string::npos);
}

TEST(ForeignExr, TheDataWindowIsPlacedInTheDisplayWindow) {
  const ScratchDir scratch;
  OIIO::ImageSpec spec = float_spec(3, 2, {"R", "G", "B"});
  spec.x = 2, spec.y = -1;  // one row above the picture, and one column beyond its right edge
  spec.full_width = 4, spec.full_height = 3;
  std::vector<float> samples;
  for (int i = 0; i < 18; ++i) samples.push_back(static_cast<float>(i + 1));
  write_with_oiio(scratch / "a.exr", spec, samples);
  const ReadMap read = read_map(scratch / "a.exr");
  ASSERT_EQ(read.map.size(), (Size{4, 3}));
  EXPECT_EQ(read.map.rgb(2, 0, 0), 10) << "second row of the data, first column";
  EXPECT_EQ(read.map.rgb(3, 0, 2), 15);
  EXPECT_EQ(read.map.rgb(1, 0, 0), 0);
  EXPECT_EQ(read.map.rgb(2, 1, 0), 0);
  EXPECT_EQ(read.warnings.size(), 1u);
}

TEST(ForeignExr, ALatLongEnvmapIsMovedToOurPixelCentres) {
  const ScratchDir scratch;
  // OpenEXR: pixel x looks at u = x/(W-1), pixel y at v = y/(H-1). A map of u and v must come back as u and v of ours.
  constexpr int kWidth = 16, kHeight = 8;
  OIIO::ImageSpec spec = float_spec(kWidth, kHeight, {"R", "G", "B"});
  spec.attribute("textureformat", "LatLong Environment");
  spec.attribute("openexr:levelmode", 0);
  std::vector<float> samples;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) samples.insert(samples.end(), {x / (kWidth - 1.f), y / (kHeight - 1.f), 1});
  }
  write_with_oiio(scratch / "a.exr", spec, samples);
  const ReadMap read = read_map(scratch / "a.exr");
  EXPECT_EQ(read.map.projection, "latlong");
  EXPECT_EQ(read.warnings.size(), 1u);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      EXPECT_NEAR(read.map.rgb(x, y, 0), (x + 0.5) / kWidth, 1e-6);
      EXPECT_NEAR(read.map.rgb(x, y, 1), (y + 0.5) / kHeight, 1e-6);
    }
  }
}

TEST(Map, OurCubeStripCarriesBothNamesAndIsNotMoved) {
  const ScratchDir scratch;
  RadianceMap map = made_up_map(8, 48);
  map.projection = "cube-strip";
  write_map(scratch / "a.exr", map, {}, {SampleType::kFloat, "piz"});
  EXPECT_EQ(OIIO::ImageInput::open((scratch / "a.exr").string())->spec().get_string_attribute("textureformat"),
            "CubeFace Environment");
  const ReadMap back = read_map(scratch / "a.exr");
  EXPECT_EQ(back.map.projection, "cube-strip");
  EXPECT_EQ(differing_samples(map.rgb, back.map.rgb), 0);
}

TEST(Map, OurLatLongCarriesBothNamesAndIsNotMoved) {
  const ScratchDir scratch;
  RadianceMap map = made_up_map(32, 16);
  map.projection = "latlong";
  write_map(scratch / "a.exr", map, {}, {SampleType::kFloat, "piz"});
  EXPECT_EQ(OIIO::ImageInput::open((scratch / "a.exr").string())->spec().get_string_attribute("textureformat"),
            "LatLong Environment");
  const ReadMap back = read_map(scratch / "a.exr");
  EXPECT_EQ(back.map.projection, "latlong");
  EXPECT_EQ(differing_samples(map.rgb, back.map.rgb), 0);
  EXPECT_TRUE(back.warnings.empty());
}

TEST(Map, OnePixelIsAPicture) {
  const ScratchDir scratch;
  for (const char* name : {"a.exr", "a.hdr", "a.tif"}) {
    write_map(scratch / name, made_up_map(1, 1));
    EXPECT_EQ(read_map(scratch / name).map.size(), (Size{1, 1})) << name;
  }
}

TEST(Map, TruncatedAndDamagedMapsNeverCrash) {
  const ScratchDir scratch;
  for (const std::string extension : {".exr", ".hdr", ".tif"}) {
    const Path path = scratch / ("a" + extension);
    write_map(path, made_up_map(64, 48));
    const std::string whole = read_text(path);
    for (const double share : {0.9, 0.5, 0.02}) {
      write_text(path, whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
      const std::string message = error_of([&] { read_map(path); });
      EXPECT_TRUE(message.starts_with(path.string() + ": ")) << share << " of " << extension << ": " << message;
    }
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      std::string bytes = whole;
      Random random(seed, 3);
      for (int hit = 0; hit < 4; ++hit) {
        const std::size_t range = hit % 2 ? bytes.size() : std::min<std::size_t>(400, bytes.size());
        bytes[random.bits() % range] = static_cast<char>(random.bits());
      }
      write_text(path, bytes);
      const std::string message = error_of([&] { read_map(path); });  // a map, or an Error that names the file
      EXPECT_TRUE(message.empty() || message.starts_with(path.string())) << message;
    }
  }
}

TEST(Info, TellsCodesAsCodesAndExposureFromExif) {
  const ScratchDir scratch;
  Photo photo = test::made_up_photo(64, 48, 8, 4, {1.0 / 250, 5.6, 400.0, 0});
  auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
  for (int y = 0; y < 48; ++y) std::fill_n(codes.row(y), 64 * 3, std::uint8_t{100});
  codes(1, 1, 0) = 250;
  write_photo(scratch / "a.png", photo);
  const FileInfo info = read_info(scratch / "a.png");
  EXPECT_EQ(info.format, "png");
  EXPECT_EQ(info.type, "uint8");
  EXPECT_EQ(info.width, 64);
  EXPECT_EQ(info.height, 48);
  EXPECT_EQ(info.channels, 3);
  EXPECT_NEAR(info.min, 100, 1e-4);
  EXPECT_NEAR(info.max, 250, 1e-4);
  EXPECT_NEAR(info.mean, 100 + 150.0 / (64 * 48 * 3), 1e-4);
  EXPECT_EQ(info.exposure.seconds, 1.0 / 250);
  EXPECT_EQ(info.exposure.iso, 400);
}

TEST(RealMaps, EveryFormatOfTheCollectionIsReadOrRefusedByName) {
  HDR_NEED_SHARED_DATA(folder, "formats");
  int read = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension();
    if (extension != ".exr" && extension != ".tif" && extension != ".pfm") continue;
    const std::string message = error_of([&] {
      const ReadMap map = read_map(entry.path());
      for (int y = 0; y < map.map.size().height; ++y) {
        const float* row = map.map.rgb.row(y);
        ASSERT_TRUE(
            std::all_of(row, row + map.map.rgb.row_samples(), [](float v) { return v >= 0 && std::isfinite(v); }));
      }
    });
    EXPECT_TRUE(message.empty() || message.starts_with(entry.path().string())) << message;
    read += message.empty();
  }
  EXPECT_GT(read, 60);
}

}  // namespace
}  // namespace hdr
