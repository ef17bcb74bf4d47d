// All of the collection of corner cases (../shared/data/formats): each file's size, channels and mean as oiiotool 2.4
// gives them, or the error that says why it is not read
// (text.tif is cut off; DDS is no format for light probes); and the pairs in it that show one picture twice.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "libhdr/core/color.h"
#include "libhdr/io/read.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

constexpr double kNoMean = std::numeric_limits<double>::quiet_NaN();

struct Row {
  const char* path;
  int width, height, channels;
  double mean;  ///< of all channels, finite samples; integers as shares of the full scale; NaN: oiiotool cannot say
  const char* error = "";
};

const Row kTable[] = {
    {"oiio_images/dds/dds_bc6hu.dds", 0, 0, 0, kNoMean, "does not begin as EXR"},
    {"oiio_images/dds/dds_bc6hu_hdr.dds", 0, 0, 0, kNoMean, "does not begin as EXR"},
    {"oiio_images/grid-overscan.exr", 1500, 1500, 4, 0.57060275},
    {"oiio_images/grid.tif", 1000, 1000, 4, 0.706539},
    {"oiio_images/libtiffpic/cramps-tile.tif", 800, 607, 1, 0.710471},
    {"oiio_images/libtiffpic/depth/flower-minisblack-02.tif", 73, 43, 1, 0.193333},
    {"oiio_images/libtiffpic/depth/flower-minisblack-04.tif", 73, 43, 1, 0.333333},
    {"oiio_images/libtiffpic/depth/flower-minisblack-06.tif", 73, 43, 1, 0.356667},
    {"oiio_images/libtiffpic/depth/flower-minisblack-08.tif", 73, 43, 1, 0.364627},
    {"oiio_images/libtiffpic/depth/flower-minisblack-10.tif", 73, 43, 1, 0.366022},
    {"oiio_images/libtiffpic/depth/flower-minisblack-12.tif", 73, 43, 1, 0.366398},
    {"oiio_images/libtiffpic/depth/flower-minisblack-14.tif", 73, 43, 1, 0.366489},
    {"oiio_images/libtiffpic/depth/flower-minisblack-16.tif", 73, 43, 1, 0.36652},
    {"oiio_images/libtiffpic/depth/flower-minisblack-24.tif", 73, 43, 1, 0.36461},
    {"oiio_images/libtiffpic/depth/flower-minisblack-32.tif", 73, 43, 1, kNoMean},
    {"oiio_images/libtiffpic/depth/flower-rgb-contig-02.tif", 73, 43, 3, 0.178889},
    {"oiio_images/libtiffpic/depth/flower-rgb-contig-04.tif", 73, 43, 3, 0.309778},
    {"oiio_images/libtiffpic/depth/flower-rgb-contig-08.tif", 73, 43, 3, 0.34132},
    {"oiio_images/libtiffpic/depth/flower-rgb-contig-10.tif", 73, 43, 3, 0.342786},
    {"oiio_images/libtiffpic/depth/flower-rgb-contig-12.tif", 73, 43, 3, 0.343149},
    {"oiio_images/libtiffpic/depth/flower-rgb-contig-14.tif", 73, 43, 3, 0.343241},
    {"oiio_images/libtiffpic/depth/flower-rgb-contig-16.tif", 73, 43, 3, 0.343271},
    {"oiio_images/libtiffpic/depth/flower-rgb-contig-24.tif", 73, 43, 3, 0.341329},
    {"oiio_images/libtiffpic/depth/flower-rgb-contig-32.tif", 73, 43, 3, kNoMean},
    {"oiio_images/libtiffpic/depth/flower-rgb-planar-02.tif", 73, 43, 3, 0.178889},
    {"oiio_images/libtiffpic/depth/flower-rgb-planar-04.tif", 73, 43, 3, 0.309778},
    {"oiio_images/libtiffpic/depth/flower-rgb-planar-08.tif", 73, 43, 3, 0.34132},
    {"oiio_images/libtiffpic/depth/flower-rgb-planar-10.tif", 73, 43, 3, 0.342786},
    {"oiio_images/libtiffpic/depth/flower-rgb-planar-12.tif", 73, 43, 3, 0.343149},
    {"oiio_images/libtiffpic/depth/flower-rgb-planar-14.tif", 73, 43, 3, 0.343241},
    {"oiio_images/libtiffpic/depth/flower-rgb-planar-16.tif", 73, 43, 3, 0.343271},
    {"oiio_images/libtiffpic/depth/flower-rgb-planar-24.tif", 73, 43, 3, 0.341329},
    {"oiio_images/libtiffpic/depth/flower-rgb-planar-32.tif", 73, 43, 3, kNoMean},
    {"oiio_images/libtiffpic/jello.tif", 256, 192, 3, 0.381333},
    {"oiio_images/libtiffpic/off_l16.tif", 333, 225, 1, kNoMean},
    {"oiio_images/libtiffpic/off_luv24.tif", 333, 225, 3, kNoMean},
    {"oiio_images/libtiffpic/off_luv32.tif", 333, 225, 3, kNoMean},
    {"oiio_images/libtiffpic/quad-lzw.tif", 512, 384, 3, 0.139948},
    {"oiio_images/libtiffpic/quad-tile.tif", 512, 384, 3, 0.139948},
    {"oiio_images/libtiffpic/smallliz.tif", 160, 160, 3, 0.391033},
    {"oiio_images/libtiffpic/text.tif", 1512, 359, 1, kNoMean, "after row 356 of 359"},
    {"oiio_images/libtiffpic/ycbcr-cat.tif", 250, 325, 3, 0.235438},
    {"oiio_images/libtiffpic/zackthecat.tif", 234, 213, 3, 0.227556},
    {"oiio_images/pnm/test-1.pfm", 64, 64, 3, 0.00150633333},
    {"oiio_images/pnm/test-2.pfm", 240, 240, 3, 0.042389},
    {"oiio_images/pnm/test-3.pfm", 240, 240, 3, 0.193474333},
    {"openexr_images/Chromaticities/Rec709.exr", 610, 406, 3, 0.252797667},
    {"openexr_images/Chromaticities/Rec709_YC.exr", 610, 406, 3, kNoMean},
    {"openexr_images/Chromaticities/XYZ.exr", 610, 406, 3, 0.235083667},
    {"openexr_images/Chromaticities/XYZ_YC.exr", 610, 406, 3, kNoMean},
    {"openexr_images/DisplayWindow/t01.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t02.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t03.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t04.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t05.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t06.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t07.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t08.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t09.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t10.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t11.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t12.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t13.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t14.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t15.exr", 400, 300, 3, 0.252247},
    {"openexr_images/DisplayWindow/t16.exr", 400, 300, 3, 0.252247},
    {"openexr_images/LuminanceChroma/Flowers.exr", 784, 734, 3, kNoMean},
    {"openexr_images/LuminanceChroma/Garden.exr", 874, 493, 1, 0.334109},
    {"openexr_images/MultiResolution/ColorCodedLevels.exr", 512, 512, 4, 0.62092675},
    {"openexr_images/MultiResolution/ColorCodedLevels.jpg", 512, 512, 1, 0.499059},
    {"openexr_images/MultiResolution/KernerEnvCube.exr", 256, 1536, 4, 0.3900175},
    {"openexr_images/MultiResolution/KernerEnvCube.jpg", 256, 1536, 3, 0.376209},
    {"openexr_images/MultiResolution/KernerEnvLatLong.exr", 1024, 512, 4, 0.373901},
    {"openexr_images/MultiResolution/KernerEnvLatLong.jpg", 1024, 512, 3, 0.355451},
    {"openexr_images/MultiResolution/OrientationCube.exr", 512, 3072, 4, 0.95905925},
    {"openexr_images/MultiResolution/OrientationCube.jpg", 512, 3072, 3, 0.968614},
    {"openexr_images/MultiResolution/OrientationLatLong.jpg", 1024, 512, 3, 0.946732},
    {"openexr_images/MultiResolution/PeriodicPattern.exr", 517, 517, 3, 0.207259333},
    {"openexr_images/MultiResolution/PeriodicPattern.jpg", 517, 517, 3, 0.408222},
    {"openexr_images/MultiResolution/StageEnvLatLong.jpg", 1000, 500, 3, 0.634222},
    {"openexr_images/MultiView/Fog.exr", 1000, 672, 2, 0.0292775},
    {"openexr_images/ScanLines/Cannon.exr", 780, 566, 3, 0.350754667},
    {"openexr_images/ScanLines/Carrots.exr", 600, 400, 4, 0.0869105},
    {"openexr_images/TestImages/AllHalfValues.exr", 256, 256, 3, kNoMean},
    {"openexr_images/TestImages/BrightRings.exr", 800, 800, 3, 27.585335},
    {"openexr_images/TestImages/BrightRingsNanInf.exr", 800, 800, 3, 27.585585},
    {"openexr_images/TestImages/GammaChart.exr", 800, 800, 3, 0.175781},
    {"openexr_images/TestImages/GrayRampsDiagonal.exr", 800, 800, 1, 0.642926},
    {"openexr_images/TestImages/GrayRampsHorizontal.exr", 800, 800, 1, 0.642926},
    {"openexr_images/TestImages/RgbRampsDiagonal.exr", 800, 800, 3, 0.237856333},
    {"openexr_images/TestImages/SquaresSwirls.exr", 1000, 1000, 3, 18.5076597},
    {"openexr_images/TestImages/WideColorGamut.exr", 800, 800, 3, 1.04775733},
    {"openexr_images/TestImages/WideFloatRange.exr", 500, 500, 1, kNoMean},
    {"openexr_images/TestImages/stripes.exr", 100, 50, 4, 0.602494},
};

double full_scale(const std::string& type) {
  return type == "uint8" ? 255 : type == "uint16" ? 65535 : type == "uint" ? 4294967295.0 : 1;
}

TEST(FormatTable, EveryFileIsReadAsOiiotoolReadsItOrRefusedWithAReason) {
  HDR_NEED_SHARED_DATA(folder, "formats");
  std::set<std::string> known;
  for (const Row& row : kTable) {
    known.insert(row.path);
    const Path path = folder / row.path;
    FileInfo info;
    const std::string error = test::error_of([&] { info = read_info(path); });
    EXPECT_EQ(error.empty(), row.error[0] == '\0') << row.path << ": " << error;
    EXPECT_NE(error.find(row.error), std::string::npos) << row.path << ": " << error;
    if (!error.empty()) continue;
    EXPECT_EQ(info.width, row.width) << row.path;
    EXPECT_EQ(info.height, row.height) << row.path;
    EXPECT_EQ(info.channels, row.channels) << row.path;
    if (std::isnan(row.mean)) continue;
    // oiiotool prints two decimals of integers, which may have 2 or 4 bits, and six of floats.
    const bool is_float = full_scale(info.type) == 1;
    const int bits = std::atoi(path.stem().string().substr(path.stem().string().size() - 2).c_str());
    const double of_integers = 0.006 / (std::exp2(bits > 0 ? bits : 8) - 1);
    EXPECT_NEAR(info.mean / full_scale(info.type), row.mean,
                is_float ? std::max(1e-6, 1e-4 * std::abs(row.mean)) : std::max(1e-6, of_integers))
        << row.path;
    EXPECT_EQ(test::error_of([&] { read_map(path); }), "") << row.path;
  }
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension();
    const bool is_text = extension == ".md" || extension == ".rst" || extension.empty();
    if (!entry.is_regular_file() || is_text) continue;
    const std::string name = std::filesystem::relative(entry.path(), folder);
    EXPECT_TRUE(known.count(name)) << name << " is not in the table";
  }
}

/// The share of samples that differ by less than `tolerance` of the larger (and a thousandth).
double agreement(const RadianceMap& a, const RadianceMap& b, double tolerance) {
  if (a.size() != b.size()) return 0;
  std::int64_t good = 0, all = 0;
  for (int y = 0; y < a.rgb.height(); ++y) {
    for (std::size_t k = 0; k < a.rgb.row_samples(); ++k, ++all) {
      const double p = a.rgb.row(y)[k], q = b.rgb.row(y)[k];
      good += std::abs(p - q) <= tolerance * (std::max(p, q) + 1e-3);
    }
  }
  return static_cast<double>(good) / static_cast<double>(all);
}

TEST(FormatPairs, TheSameLightInOtherPrimariesIsTheSameLight) {
  HDR_NEED_SHARED_DATA(folder, "formats/openexr_images/Chromaticities");
  const RadianceMap rec709 = read_map(folder / "Rec709.exr").map;
  EXPECT_GT(agreement(read_map(folder / "XYZ.exr").map, rec709, 2e-3), 0.98);
  // Chroma at half the resolution differs at edges, and nowhere else by much.
  EXPECT_GT(agreement(read_map(folder / "Rec709_YC.exr").map, rec709, 0.05), 0.8);
  EXPECT_GT(agreement(read_map(folder / "XYZ_YC.exr").map, rec709, 0.05), 0.8);
}

TEST(FormatPairs, ACubeAndALatLongOfOnePlaceAgree) {
  HDR_NEED_SHARED_DATA(folder, "formats/openexr_images/MultiResolution");
  const RadianceMap cube = read_map(folder / "KernerEnvCube.exr").map;
  EXPECT_EQ(cube.projection, "latlong");
  EXPECT_GT(agreement(cube, read_map(folder / "KernerEnvLatLong.exr").map, 0.1), 0.9);
}

TEST(FormatPairs, ThreeKindsOfLogLuvShowOneRoom) {
  HDR_NEED_SHARED_DATA(folder, "formats/oiio_images/libtiffpic");
  const RadianceMap fine = read_map(folder / "off_luv32.tif").map, coarse = read_map(folder / "off_luv24.tif").map;
  const RadianceMap grey = read_map(folder / "off_l16.tif").map;
  std::int64_t near_coarse = 0, near_grey = 0;
  for (int y = 0; y < 225; ++y) {
    for (int x = 0; x < 333; ++x) {
      const float *p = fine.rgb.pixel(x, y), *q = coarse.rgb.pixel(x, y);
      const double truth = luminance<double>(p[0], p[1], p[2]);
      near_coarse += std::abs(luminance<double>(q[0], q[1], q[2]) - truth) < 0.02 * truth;
      near_grey += std::abs(grey.rgb(x, y, 0) - truth) < 0.01 * truth;
    }
  }
  EXPECT_GT(near_coarse, 0.95 * 225 * 333);
  EXPECT_GT(near_grey, 0.95 * 225 * 333);
  EXPECT_GT(read_info(folder / "off_luv32.tif").max, 5) << "the window is far brighter than white";
}

TEST(FormatPairs, NaNAndInfinityBesideThePictureWithoutThem) {
  HDR_NEED_SHARED_DATA(folder, "formats/openexr_images/TestImages");
  const FileInfo info = read_info(folder / "BrightRingsNanInf.exr");
  EXPECT_GT(info.nan + info.inf, 0);
  const ReadMap mended = read_map(folder / "BrightRingsNanInf.exr");
  ASSERT_EQ(mended.warnings.size(), 1u);
  EXPECT_GT(agreement(mended.map, read_map(folder / "BrightRings.exr").map, 1e-6), 0.999);
}

}  // namespace
}  // namespace hdr
