// Photographs out and in again: codes, exposure, orientation, and what is no photograph.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libhdr/io/output_file.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

using test::differing_samples;
using test::error_of;
using test::made_up_photo;
using test::ScratchDir;
using Bytes = Image<std::uint8_t>;
using Words = Image<std::uint16_t>;

TEST(Photo, LosslessFormatsKeepEveryCode) {
  const ScratchDir scratch;
  for (const char* name : {"a.png", "a.tif"}) {
    const Photo eight = made_up_photo(61, 43, 8, 1), sixteen = made_up_photo(61, 43, 16, 2);
    write_photo(scratch / name, eight);
    const Photo eight_back = read_photo(scratch / name);
    EXPECT_EQ(eight_back.bits, 8);
    EXPECT_FALSE(eight_back.lossy);
    EXPECT_EQ(differing_samples(std::get<Bytes>(eight.codes), std::get<Bytes>(eight_back.codes)), 0) << name;
    write_photo(scratch / name, sixteen);
    const Photo sixteen_back = read_photo(scratch / name);
    EXPECT_EQ(sixteen_back.bits, 16);
    EXPECT_EQ(differing_samples(std::get<Words>(sixteen.codes), std::get<Words>(sixteen_back.codes)), 0) << name;
  }
}

TEST(Photo, JpegIsLossyAndClose) {
  const ScratchDir scratch;
  Photo photo = made_up_photo(160, 120, 8, 3);
  Bytes& codes = std::get<Bytes>(photo.codes);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) std::fill_n(codes.pixel(x, y), 3, static_cast<std::uint8_t>(x + y / 2));
  }
  write_photo(scratch / "a.jpg", photo, 95);
  const Photo back = read_photo(scratch / "a.jpg");
  EXPECT_TRUE(back.lossy);
  int worst = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) worst = std::max(worst, std::abs(codes(x, y) - std::get<Bytes>(back.codes)(x, y)));
  }
  EXPECT_LE(worst, 4) << "a smooth grey ramp at quality 95";
  write_photo(scratch / "b.jpg", photo, 30);
  EXPECT_LT(std::filesystem::file_size(scratch / "b.jpg"), std::filesystem::file_size(scratch / "a.jpg"));
  const auto input = OIIO::ImageInput::open((scratch / "a.jpg").string());
  EXPECT_EQ(input->spec().get_string_attribute("jpeg:subsampling"), "4:2:0") << "chroma as cameras write it";
  EXPECT_NE(error_of([&] { write_photo(scratch / "c.jpg", made_up_photo(8, 8, 16, 4)); }).find("8 bits"),
            std::string::npos);
}

TEST(Photo, ExposureComesBackFromEveryFormat) {
  const ScratchDir scratch;
  for (const char* name : {"a.jpg", "a.png", "a.tif"}) {
    for (const double seconds : {1.0 / 60, 0.0125, 30.0, 1.0 / 8000, 1.0 / 3049, 2.5, 1.3, 1e-5, 4000.0}) {
      write_photo(scratch / name, made_up_photo(16, 16, 8, 5, {seconds, 5.6, 200.0, 0}));
      const Exposure back = read_photo(scratch / name).exposure;
      ASSERT_TRUE(back.seconds && back.f_number && back.iso) << name << " at " << seconds << " s";
      EXPECT_DOUBLE_EQ(*back.seconds, seconds) << name;
      EXPECT_DOUBLE_EQ(*back.f_number, 5.6) << name;
      EXPECT_DOUBLE_EQ(*back.iso, 200) << name;
    }
    // A time that is neither decimal nor 1/n keeps the precision of EXIF as OpenImageIO gives it: a float.
    write_photo(scratch / name, made_up_photo(16, 16, 8, 6, {0.7234567891234, std::nullopt, 204800.0, 0}));
    const Exposure odd = read_photo_header(scratch / name).exposure;
    EXPECT_NEAR(*odd.seconds, 0.7234567891234, 1e-7) << name;
    EXPECT_FALSE(odd.f_number) << name;
    EXPECT_EQ(odd.iso.value_or(0), 204800) << "beyond EXIF's 16-bit field; " << name;
    write_photo(scratch / name, made_up_photo(16, 16, 8, 7));
    EXPECT_FALSE(read_photo(scratch / name).exposure.seconds) << name;
  }
}

TEST(Photo, SameWorkSameBytes) {
  const ScratchDir scratch;
  const Photo photo = made_up_photo(64, 48, 8, 8, {0.01, 4.0, 100.0, 0});
  for (const std::string extension : {".jpg", ".png", ".tif"}) {
    write_photo(scratch / ("a" + extension), photo);
    write_photo(scratch / ("b" + extension), photo);
    EXPECT_EQ(read_text(scratch / ("a" + extension)), read_text(scratch / ("b" + extension))) << extension;
    // A clock time would agree by luck when both are written within one second.
    EXPECT_FALSE(OIIO::ImageInput::open((scratch / ("a" + extension)).string())->spec().find_attribute("DateTime"))
        << extension;
  }
}

/// Horizontal field by a sensor's resolution, degrees; 0: none.
double field_on_sensor(const Path& path, float per_unit, int unit, int written_width, int orientation = 1) {
  OIIO::ImageSpec spec(600, 400, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("Exif:FocalLength", 50.0f);
  spec.attribute("Exif:FocalPlaneXResolution", per_unit);
  spec.attribute("Exif:FocalPlaneYResolution", per_unit);
  spec.attribute("Exif:FocalPlaneResolutionUnit", unit);
  spec.attribute("Exif:PixelXDimension", written_width);
  spec.attribute("Orientation", orientation);
  const std::vector<std::uint8_t> bytes(spec.image_bytes(), 90);
  const auto out = OIIO::ImageOutput::create(path.string());
  EXPECT_TRUE(out->open(path.string(), spec) && out->write_image(spec.format, bytes.data()) && out->close());
  return read_photo_header(path).fov_degrees.value_or(0);
}

TEST(Photo, ASensorsResolutionGivesTheFieldOfWholePicturesAlone) {
  const ScratchDir scratch;
  constexpr double kDegrees = 39.5978;  // 2 atan(18 / 50): 600 pixels on 36 mm
  EXPECT_NEAR(field_on_sensor(scratch / "a.jpg", 600 / 36.0f * 25.4f, 2, 600), kDegrees, 1e-3) << "inches";
  EXPECT_NEAR(field_on_sensor(scratch / "a.jpg", 600 / 36.0f * 10, 3, 600), kDegrees, 1e-3) << "centimetres";
  EXPECT_NEAR(field_on_sensor(scratch / "a.jpg", 600 / 36.0f * 10, 3, 600, 6), 26.9915, 1e-3) << "24 mm upright";
  EXPECT_EQ(field_on_sensor(scratch / "a.jpg", 600 / 36.0f * 10, 3, 1200), 0) << "half as wide as it was written";
  EXPECT_EQ(field_on_sensor(scratch / "a.jpg", 600 / 36.0f * 10, 2, 600), 0) << "no sensor is 91 mm wide";
  EXPECT_EQ(field_on_sensor(scratch / "a.jpg", 0, 2, 600), 0) << "0: unknown";
}

TEST(Photo, ALensIsWrittenAsItIsRead) {
  const ScratchDir scratch;
  const Photo photo = made_up_photo(64, 48, 8, 8, {0.01, 4.0, 100.0, 0});
  for (const std::string extension : {".jpg", ".png", ".tif"}) {
    for (const double degrees : {1.5, 39.5978, 110.0}) {
      write_photo(scratch / ("a" + extension), photo, 95, degrees);
      const PhotoHeader header = read_photo_header(scratch / ("a" + extension));
      EXPECT_NEAR(header.fov_degrees.value_or(0), degrees, 1e-5 * degrees) << extension;
      EXPECT_TRUE(header.fov_by_sensor) << extension;
      EXPECT_EQ(header.exposure.seconds, photo.exposure.seconds) << extension;
      EXPECT_EQ(header.exposure.iso, photo.exposure.iso) << extension;
    }
    write_photo(scratch / ("a" + extension), photo);
    EXPECT_FALSE(read_photo_header(scratch / ("a" + extension)).fov_degrees) << extension;
  }
}

/// A 3 x 2 picture whose codes tell the position in the UPRIGHT picture: red = column, green = row.
void write_oriented(const Path& path, int orientation) {
  const bool on_its_side = orientation >= 5;
  const int w = on_its_side ? 2 : 3, h = on_its_side ? 3 : 2;  // as stored
  std::array<std::uint8_t, 3 * 2 * 3> codes{};
  for (int row = 0; row < h; ++row) {
    for (int column = 0; column < w; ++column) {
      // TIFF 6.0, Orientation: what the 0th row and the 0th column of the stored picture are in the upright one.
      int x = column, y = row;
      switch (orientation) {
        case 2:
          x = 2 - column;
          break;
        case 3:
          x = 2 - column, y = 1 - row;
          break;
        case 4:
          y = 1 - row;
          break;
        case 5:
          x = row, y = column;
          break;  // 0th row: left, 0th column: top
        case 6:
          x = 2 - row, y = column;
          break;  // right, top
        case 7:
          x = 2 - row, y = 1 - column;
          break;  // right, bottom
        case 8:
          x = row, y = 1 - column;
          break;  // left, bottom
        default:
          break;
      }
      const auto at = static_cast<std::size_t>(row * w + column) * 3;
      codes.at(at) = static_cast<std::uint8_t>(10 * x);
      codes.at(at + 1) = static_cast<std::uint8_t>(10 * y);
    }
  }
  OIIO::ImageSpec spec(w, h, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("Orientation", orientation);
  const auto out = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(out->open(path.string(), spec) && out->write_image(OIIO::TypeDesc::UINT8, codes.data()) && out->close());
}

TEST(Photo, EveryOrientationComesOutUpright) {
  const ScratchDir scratch;
  for (int orientation = 1; orientation <= 8; ++orientation) {
    write_oriented(scratch / "a.tif", orientation);
    const Photo photo = read_photo(scratch / "a.tif");
    ASSERT_EQ(photo.size(), (Size{3, 2})) << "orientation " << orientation;
    EXPECT_EQ(read_photo_header(scratch / "a.tif").size, (Size{3, 2})) << "orientation " << orientation;
    const Bytes& codes = std::get<Bytes>(photo.codes);
    for (int y = 0; y < 2; ++y) {
      for (int x = 0; x < 3; ++x) {
        EXPECT_EQ(codes(x, y, 0), 10 * x) << "orientation " << orientation;
        EXPECT_EQ(codes(x, y, 1), 10 * y) << "orientation " << orientation;
      }
    }
  }
}

TEST(Photo, GreyIsRepeatedAndAlphaDropped) {
  const ScratchDir scratch;
  for (const int channels : {1, 2, 4}) {
    std::vector<std::uint8_t> codes;
    for (int i = 0; i < 6 * channels; ++i) codes.push_back(static_cast<std::uint8_t>(40 * (i % channels) + i));
    OIIO::ImageSpec spec(3, 2, channels, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    const std::string path = (scratch / "a.png").string();
    const auto out = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(out->open(path, spec) && out->write_image(OIIO::TypeDesc::UINT8, codes.data()) && out->close());
    const Photo photo = read_photo(path);
    const Bytes& back = std::get<Bytes>(photo.codes);
    for (int i = 0; i < 6; ++i) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(back(i % 3, i / 3, c), codes[static_cast<std::size_t>(i * channels + (channels < 3 ? 0 : c))])
            << channels << " channels: codes are those of the file, not multiplied by alpha";
      }
    }
  }
}

TEST(Photo, ApexValuesStandInForAMissingTime) {
  const ScratchDir scratch;
  OIIO::ImageSpec spec(8, 8, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("Exif:ShutterSpeedValue", 6.0f);  // EXIF 2.3 annex C: 2^-6 s
  spec.attribute("Exif:ApertureValue", 4.0f);      // 2^(4/2)
  const std::string path = (scratch / "a.jpg").string();
  const std::vector<std::uint8_t> codes(8 * 8 * 3, 100);
  const auto out = OIIO::ImageOutput::create(path);
  ASSERT_TRUE(out->open(path, spec) && out->write_image(OIIO::TypeDesc::UINT8, codes.data()) && out->close());
  const Exposure exposure = read_photo(path).exposure;
  EXPECT_DOUBLE_EQ(exposure.seconds.value_or(0), 1.0 / 64);
  EXPECT_DOUBLE_EQ(exposure.f_number.value_or(0), 4.0);
}

TEST(Photo, AZeroExifTimeIsAnErrorNamingTheFile) {
  const ScratchDir scratch;
  write_photo(scratch / "a.jpg", made_up_photo(8, 8, 8, 9, {0.0, 4.0, 100.0, 0}));
  const std::string message = error_of([&] { read_photo(scratch / "a.jpg"); });
  EXPECT_TRUE(message.starts_with((scratch / "a.jpg").string() + ": the exposure time in EXIF is 0 s")) << message;
  EXPECT_NE(message.find("--times"), std::string::npos) << message;
  EXPECT_EQ(error_of([&] { read_photo_header(scratch / "a.jpg"); }), message);
}

TEST(Photo, TruncatedFilesAreErrorsNamingTheFile) {
  const ScratchDir scratch;
  for (const std::string extension : {".jpg", ".png", ".tif"}) {
    const Path whole = scratch / ("whole" + extension), cut = scratch / ("cut" + extension);
    write_photo(whole, made_up_photo(200, 150, 8, 10, {0.01, 4.0, 100.0, 0}));
    const std::string bytes = read_text(whole);
    for (const double share : {0.99, 0.6, 0.1, 0.01}) {
      write_text(cut, bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size()))));
      const std::string message = error_of([&] { read_photo(cut); });
      EXPECT_TRUE(message.starts_with(cut.string() + ": ")) << share << " of " << extension << ": " << message;
    }
    if (extension == ".jpg") {
      write_text(cut, bytes.substr(0, bytes.size() / 2));
      EXPECT_NE(error_of([&] { read_photo(cut); }).find("truncated"), std::string::npos);
      write_text(cut, bytes.substr(0, bytes.size() / 2) + std::string(bytes.size() / 2, '\0'));
      EXPECT_NE(error_of([&] { read_photo(cut); }).find("truncated"), std::string::npos) << "padded with zeros";
      write_text(cut, bytes + "trailing bytes, as of a second picture");
      EXPECT_EQ(error_of([&] { read_photo(cut); }), "");
    }
  }
}

TEST(Photo, WhatIsNoPhotographIsAnErrorNamingTheFile) {
  const ScratchDir scratch;
  write_text(scratch / "text.jpg", "this is a text\n");
  write_text(scratch / "empty.jpg", "");
  RadianceMap map;
  map.rgb = Image<float>(4, 4, 3);
  write_map(scratch / "map.exr", map);
  const auto refusal = [&](const std::string& name) { return error_of([&] { read_photo(scratch / name); }); };
  EXPECT_NE(refusal("text.jpg").find("text.jpg: not a picture"), std::string::npos) << refusal("text.jpg");
  EXPECT_NE(refusal("empty.jpg").find("empty.jpg: is empty"), std::string::npos) << refusal("empty.jpg");
  EXPECT_NE(refusal("absent.jpg").find("absent.jpg: no such file"), std::string::npos) << refusal("absent.jpg");
  EXPECT_NE(refusal(".").find("is a folder"), std::string::npos) << refusal(".");
  EXPECT_NE(refusal("map.exr").find("map.exr: a radiance map"), std::string::npos) << refusal("map.exr");
}

TEST(Photo, DamagedFilesNeverCrash) {
  const ScratchDir scratch;
  for (const std::string extension : {".jpg", ".png", ".tif"}) {
    write_photo(scratch / ("whole" + extension), made_up_photo(40, 30, 8, 11, {0.01, 4.0, 100.0, 0}));
    const std::string whole = read_text(scratch / ("whole" + extension));
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      std::string bytes = whole;
      Random random(seed, 12);
      for (int hit = 0; hit < 4; ++hit) {
        // Half of the hits in the first 400 bytes, where the structure is.
        const std::size_t range = hit % 2 ? bytes.size() : std::min<std::size_t>(400, bytes.size());
        bytes[random.bits() % range] = static_cast<char>(random.bits());
      }
      const Path path = scratch / ("damaged" + extension);
      write_text(path, bytes);
      const std::string message = error_of([&] { read_photo(path); });  // a picture, or an Error that names the file
      EXPECT_TRUE(message.empty() || message.starts_with(path.string())) << message;
    }
  }
}

TEST(Photo, ADamagedColourProfileIsAnError) {
  const ScratchDir scratch;
  write_photo(scratch / "a.jpg", made_up_photo(16, 16, 8, 13));
  std::string bytes = read_text(scratch / "a.jpg");
  // Chunk 5 of 2: readers that trust it write outside their table.
  const std::string chunk = std::string("\xff\xe2\x00\x14", 4) + std::string("ICC_PROFILE\0\x05\x02", 14) + "abcd";
  bytes.insert(2, chunk);
  write_text(scratch / "b.jpg", bytes);
  EXPECT_NE(error_of([&] { read_photo(scratch / "b.jpg"); }).find("b.jpg: its colour profile"), std::string::npos);
}

TEST(IsPhotoName, KnowsPhotographsFromMaps) {
  for (const char* name : {"a.jpg", "B.JPG", "c.jpeg", "d.png", "e.TIF", "f.tiff"})
    EXPECT_TRUE(is_photo_name(name)) << name;
  for (const char* name : {"a.exr", "b.hdr", "c.pfm", "d.txt", "e", "bracket.json"})
    EXPECT_FALSE(is_photo_name(name)) << name;
}

TEST(WritePicture, KeepsCodesAndAlpha) {
  const ScratchDir scratch;
  Image<std::uint8_t> codes(5, 4, 4);
  for (int y = 0; y < 4; ++y) {
    for (int i = 0; i < 20; ++i) codes.row(y)[i] = static_cast<std::uint8_t>(13 * i + 7 * y);
  }
  write_picture(scratch / "a.png", codes);
  OIIO::ImageSpec raw;
  raw.attribute("oiio:UnassociatedAlpha", 1);
  const auto in = OIIO::ImageInput::open((scratch / "a.png").string(), &raw);
  Image<std::uint8_t> back(5, 4, 4);
  for (int y = 0; y < 4; ++y) ASSERT_TRUE(in->read_native_scanline(0, 0, y, 0, back.row(y)));
  EXPECT_EQ(differing_samples(codes, back), 0);
  write_picture(scratch / "a.jpg", codes);
  EXPECT_EQ(read_photo(scratch / "a.jpg").size(), codes.size()) << "JPEG drops alpha";
  EXPECT_NE(error_of([&] { write_picture(scratch / "a.exr", codes); }).find("a.exr: cannot be written"),
            std::string::npos);
}

// OpenImageIO 2.4 trusts the offsets in a profile's table of tags, and reads wherever they point.
TEST(Photo, AProfileThatPointsBeyondItselfIsNotFollowed) {
  const ScratchDir scratch;
  write_photo(scratch / "plain.jpg", test::made_up_photo(32, 24, 8, 3, {0.01, 8.0, 100.0, 0}));
  std::string bytes = read_text(scratch / "plain.jpg");
  std::string profile(128, '\0');
  profile.replace(36, 4, "acsp");
  profile += std::string("\0\0\0\1desc\x3f\0\0\0\0\0\x40\0", 16);
  const std::string body = std::string("ICC_PROFILE\0\1\1", 14) + profile;
  const std::size_t length = body.size() + 2;
  bytes.insert(2, std::string("\xff\xe2", 2) + static_cast<char>(length >> 8) + static_cast<char>(length & 255) + body);
  write_text(scratch / "profile.jpg", bytes);
  const Photo plain = read_photo(scratch / "plain.jpg"), with = read_photo(scratch / "profile.jpg");
  EXPECT_EQ(with.exposure.seconds, plain.exposure.seconds);
  EXPECT_EQ(std::get<Image<std::uint8_t>>(with.codes)(31, 23, 2),
            std::get<Image<std::uint8_t>>(plain.codes)(31, 23, 2));
}

}  // namespace
}  // namespace hdr
