// What cameras write about exposure, and what is to be made of it.
#include <OpenImageIO/imageio.h>

#include <cmath>

#include "libhdr/io/bracket.h"
#include "libhdr/io/read.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

using test::error_of;
using test::ScratchDir;

struct Tags {
  float seconds, bias;
  std::optional<float> f_number;
  std::optional<int> iso;
};

/// A JPEG of a ramp, `stops` brighter, with the tags a camera would write.
Path camera_jpeg(const ScratchDir& scratch, const std::string& name, double stops, const Tags& tags) {
  OIIO::ImageSpec spec(96, 64, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("ExposureTime", tags.seconds);
  spec.attribute("Exif:ExposureBiasValue", tags.bias);
  if (tags.f_number) spec.attribute("FNumber", *tags.f_number);
  if (tags.iso) spec.attribute("Exif:PhotographicSensitivity", *tags.iso);
  std::vector<std::uint8_t> codes;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const double level = std::min(1.0, std::exp2(8.0 * x / 96 - 7 + stops + 0.1 * std::sin(0.3 * y)));
      codes.insert(codes.end(), 3, static_cast<std::uint8_t>(std::lround(255 * std::pow(level, 1 / 2.2))));
    }
  }
  const Path path = scratch / name;
  const auto out = OIIO::ImageOutput::create(path.string());
  EXPECT_TRUE(out->open(path.string(), spec) && out->write_image(OIIO::TypeDesc::UINT8, codes.data()) && out->close());
  return path;
}

TEST(ExifTruth, ExposureBiasIsNoExposure) {
  const ScratchDir scratch;
  // A camera on manual records what the meter would have liked: the bias differs, the exposure does not.
  const std::string same = error_of([&] {
    read_bracket(
        {camera_jpeg(scratch, "a.jpg", 0, {0.01f, -2, 8, 100}), camera_jpeg(scratch, "b.jpg", 0, {0.01f, 2, 8, 100})});
  });
  EXPECT_NE(same.find("same exposure"), std::string::npos) << same;
  // With times that differ the bias says the same once more, and must not be counted twice.
  const Bracket bracket = read_bracket(
      {camera_jpeg(scratch, "c.jpg", 0, {0.01f, -1, 8, 100}), camera_jpeg(scratch, "d.jpg", 2, {0.04f, 1, 8, 100})});
  EXPECT_NEAR(bracket.shots[1].relative_exposure() / bracket.shots[0].relative_exposure(), 4, 1e-3);
}

TEST(ExifTruth, IsoAndApertureInsideABracketCount) {
  const ScratchDir scratch;
  const Bracket by_iso = read_bracket(
      {camera_jpeg(scratch, "a.jpg", 0, {0.01f, 0, 8, 100}), camera_jpeg(scratch, "b.jpg", 3, {0.01f, 0, 8, 800})});
  EXPECT_NEAR(by_iso.shots[1].relative_exposure() / by_iso.shots[0].relative_exposure(), 8, 1e-3);
  const Bracket by_aperture = read_bracket(
      {camera_jpeg(scratch, "c.jpg", 0, {0.01f, 0, 8, 100}), camera_jpeg(scratch, "d.jpg", 2, {0.01f, 0, 4, 100})});
  EXPECT_NEAR(by_aperture.shots[1].relative_exposure() / by_aperture.shots[0].relative_exposure(), 4, 1e-3);
}

TEST(ExifTruth, AMissingApertureIsConstantAndSaid) {
  const ScratchDir scratch;
  const Bracket bracket = read_bracket(
      {camera_jpeg(scratch, "a.jpg", 0, {0.01f, 0, {}, 100}), camera_jpeg(scratch, "b.jpg", 2, {0.04f, 0, {}, 100})});
  ASSERT_EQ(bracket.warnings.size(), 1u);
  EXPECT_NE(bracket.warnings[0].find("no aperture"), std::string::npos) << bracket.warnings[0];
  // One manual lens among automatic ones: an aperture that only some shots have is dropped for all.
  const Bracket mixed = read_bracket(
      {camera_jpeg(scratch, "c.jpg", 0, {0.01f, 0, 8, 100}), camera_jpeg(scratch, "d.jpg", 2, {0.04f, 0, {}, 100})});
  EXPECT_NEAR(mixed.shots[1].relative_exposure() / mixed.shots[0].relative_exposure(), 4, 1e-3);
  EXPECT_NE(mixed.warnings[0].find("only 1 of 2 shots have an aperture"), std::string::npos) << mixed.warnings[0];
}

}  // namespace
}  // namespace hdr
