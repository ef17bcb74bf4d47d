// PFM and the logarithmic TIFFs, out and in again, and against other readers.
#include <OpenImageIO/imageio.h>
#include <tiffio.h>

#include <algorithm>
#include <cmath>

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

RadianceMap scene(int width, int height, double stops) {
  RadianceMap map;
  map.rgb = test::test_scene(width, height, stops, 7);
  return map;
}

Image<float> read_with_oiio(const Path& path) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) return {};
  Image<float> image(input->spec().width, input->spec().height, input->spec().nchannels);
  for (int y = 0; y < image.height(); ++y) input->read_scanline(y, 0, OIIO::TypeDesc::FLOAT, image.row(y));
  return image;
}

TEST(Pfm, KeepsEveryBitAndOpenImageIoAgrees) {
  const ScratchDir scratch;
  const RadianceMap map = scene(37, 200, 30);
  write_map(scratch / "a.pfm", map);
  EXPECT_EQ(differing_samples(map.rgb, read_map(scratch / "a.pfm").map.rgb), 0);
  EXPECT_EQ(differing_samples(map.rgb, read_with_oiio(scratch / "a.pfm")), 0);
}

TEST(Pfm, GreyIsLuminance) {
  const ScratchDir scratch;
  const RadianceMap map = scene(9, 300, 10);
  WriteOptions options;
  options.grey = true;
  write_map(scratch / "a.pfm", map, {}, options);
  const Image<float> theirs = read_with_oiio(scratch / "a.pfm");
  ASSERT_EQ(theirs.channels(), 1);
  const ReadMap back = read_map(scratch / "a.pfm");
  const float* p = map.rgb.pixel(5, 250);
  EXPECT_FLOAT_EQ(theirs(5, 250), luminance(p[0], p[1], p[2]));
  EXPECT_EQ(back.map.rgb(5, 250, 2), theirs(5, 250));
  ASSERT_EQ(back.warnings.size(), 1u);
  EXPECT_NE(back.warnings[0].find("luminance only"), std::string::npos);
}

TEST(Pfm, ScaleMultipliesAndDamageIsSaid) {
  const ScratchDir scratch;
  const std::string one("\0\0\x80\x3f", 4);
  write_text(scratch / "a.pfm", "Pf\n# made by hand\n1 2\n-2.5\n" + one + one);
  EXPECT_EQ(read_map(scratch / "a.pfm").map.rgb(0, 0, 0), 2.5f);
  const auto message = [&](const std::string& bytes) {
    write_text(scratch / "a.pfm", bytes);
    return error_of([&] { read_map(scratch / "a.pfm"); });
  };
  EXPECT_NE(message("Pf\n1 3\n-1\n" + one + one).find("after row 2 of 3 (from the bottom)"), std::string::npos);
  EXPECT_NE(message("PF\n1000000 1000000\n-1\n" + one).find("after row 0"), std::string::npos);
  EXPECT_NE(message("PF\n1 1\n0\n" + one + one + one).find("scale"), std::string::npos);
  EXPECT_NE(message("PF\n-1 1\n1\n" + one + one + one).find("no width"), std::string::npos);
}

/// Pixar's log has 11 bits: steps of 0.4 % above 0.018, equal ones of 7.3e-5 below; below 2 libtiff cuts to such a step
/// before it looks the code up.
TEST(LogTiff, PixarsLogKeepsItsElevenBits) {
  const ScratchDir scratch;
  RadianceMap map = scene(64, 40, 12);
  for (int y = 0; y < 40; ++y) {
    for (float* v = map.rgb.row(y); v != map.rgb.row(y) + 192; ++v) *v = std::min(*v, 24.0f);
  }
  map.rgb(0, 0, 0) = 0;
  map.rgb(1, 0, 0) = 24.0f;
  write_map(scratch / "a.tif", map, {}, {SampleType::kFloat, "pixarlog"});
  const ReadMap back = read_map(scratch / "a.tif");
  EXPECT_TRUE(back.warnings.empty());
  EXPECT_EQ(back.map.rgb(0, 0, 0), 0);
  for (int y = 0; y < 40; ++y) {
    for (int k = 0; k < 192; ++k) {
      const double truth = map.rgb.row(y)[k];
      EXPECT_LE(std::abs(back.map.rgb.row(y)[k] - truth), 0.0021 * truth + 7.4e-5) << truth;
    }
  }
  EXPECT_EQ(read_info(scratch / "a.tif").compression, "pixarlog");
  map.rgb(3, 3, 1) = map.rgb(3, 3, 2) = 25.f;
  const std::string message = error_of([&] {
    write_map(scratch / "b.tif", map, {}, {SampleType::kFloat, "pixarlog"});
  });
  EXPECT_NE(message.find("1 pixels exceed"), std::string::npos) << message;
  EXPECT_FALSE(std::filesystem::exists(scratch / "b.tif"));
}

TEST(LogTiff, LogLuvKeepsLuminanceAndColourWithinItsSteps) {
  const ScratchDir scratch;
  const RadianceMap map = scene(64, 40, 20);
  // [Larson98]: 32 bits step by 0.27 % in luminance and 1/410 in u', v'; 24 bits by 1.1 % over 16 stops.
  write_map(scratch / "a.tif", map, {}, {SampleType::kFloat, "logluv"});
  const Image<float> back = read_map(scratch / "a.tif").map.rgb.clone();
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float *p = map.rgb.pixel(x, y), *q = back.pixel(x, y);
      const double truth = luminance<double>(p[0], p[1], p[2]), found = luminance<double>(q[0], q[1], q[2]);
      EXPECT_NEAR(found / truth, 1, 0.0028) << "half a step up or down, and what rounding to float adds";
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(q[c] / truth, p[c] / truth, 0.06) << "chroma in steps of 1/410";
    }
  }
  write_map(scratch / "g.tif", map, {}, {SampleType::kFloat, "logl"});
  const RadianceMap grey = read_map(scratch / "g.tif").map;
  const float* p = map.rgb.pixel(20, 20);
  EXPECT_NEAR(grey.rgb(20, 20, 1) / luminance<double>(p[0], p[1], p[2]), 1, 0.0028);
  RadianceMap narrow = scene(64, 40, 6);
  write_map(scratch / "c.tif", narrow, {}, {SampleType::kFloat, "logluv24"});
  const float* n = narrow.rgb.pixel(9, 9);
  const RadianceMap read = read_map(scratch / "c.tif").map;
  const float* m = read.rgb.pixel(9, 9);
  EXPECT_NEAR(luminance<double>(m[0], m[1], m[2]) / luminance<double>(n[0], n[1], n[2]), 1, 0.012);
}

/// The numbers in the file, decoded as the paper has them.
TEST(LogTiff, ThePapersOwnFormulaAgrees) {
  const ScratchDir scratch;
  const RadianceMap map = scene(32, 16, 14);
  write_map(scratch / "a.tif", map, {}, {SampleType::kFloat, "logluv"});
  const RadianceMap read = read_map(scratch / "a.tif").map;
  TIFF* tiff = TIFFOpen((scratch / "a.tif").c_str(), "r");
  ASSERT_TRUE(tiff);
  TIFFSetField(tiff, TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_RAW);
  std::vector<std::uint32_t> row(32);
  for (int y = 0; y < 16; ++y) {
    ASSERT_EQ(TIFFReadScanline(tiff, row.data(), static_cast<std::uint32_t>(y)), 1);
    for (int x = 0; x < 32; ++x) {
      const std::uint32_t code = row[static_cast<std::size_t>(x)];
      const double luma = std::exp2(((code >> 16 & 0x7fff) + 0.5) / 256 - 64);
      const double u = ((code >> 8 & 255) + 0.5) / 410, v = ((code & 255) + 0.5) / 410;
      const double cx = 9 * u / (6 * u - 16 * v + 12), cy = 4 * v / (6 * u - 16 * v + 12);
      const double big_x = cx / cy * luma, big_z = (1 - cx - cy) / cy * luma;
      const double red = 3.2404542 * big_x - 1.5371385 * luma - 0.4985314 * big_z;  // IEC 61966-2-1
      EXPECT_NEAR(read.rgb(x, y, 0), std::max(0.0, red), 2e-3 * luma);
    }
  }
  TIFFClose(tiff);
}

}  // namespace
}  // namespace hdr
