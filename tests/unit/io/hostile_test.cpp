// Files that mean harm or were badly harmed: refused in words, before memory is asked for; and files with more in them
// than a picture, of which only the picture counts.
#include <tiffio.h>

#include <algorithm>
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

/// What each way to read it says.
std::string all_errors_of(const Path& path) {
  return error_of([&] { read_info(path); }) + error_of([&] { read_map(path); }) + error_of([&] { read_photo(path); });
}

TEST(Hostile, AJpegThatPromisesTooMuch) {
  const ScratchDir scratch;
  const Path path = scratch / "a.jpg";
  write_photo(path, made_up_photo(64, 48, 8, 1));
  std::string bytes = read_text(path);
  const std::size_t frame = bytes.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  bytes.replace(frame + 5, 4, "\xff\xdc\xff\xdc");
  write_text(path, bytes);
  const std::string message = error_of([&] { read_photo(path); });
  EXPECT_NE(message.find("promises 65500 x 65500 pixels"), std::string::npos) << message;
}

TEST(Hostile, ATiffAndAnExrOfAMillionByAMillion) {
  const ScratchDir scratch;
  RadianceMap map;
  map.rgb = test::test_scene(48, 32, 4, 1);
  write_map(scratch / "a.tif", map, {}, {SampleType::kFloat, "zip", false});
  TIFF* tiff = TIFFOpen((scratch / "a.tif").c_str(), "r+");
  ASSERT_TRUE(tiff);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 1000000);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 1000000);
  TIFFRewriteDirectory(tiff);
  TIFFClose(tiff);
  EXPECT_NE(error_of([&] { read_map(scratch / "a.tif"); }).find("a.tif: "), std::string::npos);

  write_map(scratch / "a.exr", map);
  std::string bytes = read_text(scratch / "a.exr");
  const std::size_t window = bytes.find("dataWindow");
  ASSERT_NE(window, std::string::npos);
  const std::string largest("\x3f\x42\x0f\0\x3f\x42\x0f\0", 8);  // 999999
  bytes.replace(window + std::string("dataWindow").size() + 1 + std::string("box2i").size() + 1 + 4 + 8, 8, largest);
  write_text(scratch / "a.exr", bytes);
  const std::string message = error_of([&] { read_map(scratch / "a.exr"); });
  EXPECT_NE(message.find("a.exr: "), std::string::npos) << message;
}

TEST(Hostile, ColourProfilesAreNotTrusted) {
  const ScratchDir scratch;
  const Photo photo = made_up_photo(40, 30, 8, 3);
  write_photo(scratch / "plain.tif", photo);
  Random random(9, 0);
  for (int k = 0; k < 40; ++k) {
    // A profile that begins well, with counts and offsets that lead anywhere.
    std::string profile(128, '\0');
    profile.replace(36, 4, "acsp");
    for (int i = 0; i < 60; ++i) profile += static_cast<char>(random.bits());
    for (const int at : {0, 1, 2, 3, 128, 129, 130, 131})
      profile[static_cast<std::size_t>(at)] = static_cast<char>(random.bits());
    std::filesystem::copy_file(scratch / "plain.tif", scratch / "a.tif",
                               std::filesystem::copy_options::overwrite_existing);
    TIFF* tiff = TIFFOpen((scratch / "a.tif").c_str(), "r+");
    ASSERT_TRUE(tiff);
    TIFFSetField(tiff, TIFFTAG_ICCPROFILE, static_cast<std::uint32_t>(profile.size()), profile.data());
    TIFFRewriteDirectory(tiff);
    TIFFClose(tiff);
    const Photo read = read_photo(scratch / "a.tif");
    EXPECT_EQ(differing_samples(std::get<0>(read.codes), std::get<0>(photo.codes)), 0);
  }
}

TEST(Hostile, WhatItIsCalledDoesNotDecideWhoReadsIt) {
  const ScratchDir scratch;
  const Photo photo = made_up_photo(40, 30, 8, 3);
  write_photo(scratch / "a.png", photo);
  for (const char* name : {"a.psd", "a.dds", "a.tif", "a.exr", "a.hdr", "a.gif", "a"}) {
    write_text(scratch / name, read_text(scratch / "a.png"));
    EXPECT_EQ(differing_samples(std::get<0>(read_photo(scratch / name).codes), std::get<0>(photo.codes)), 0) << name;
  }
  write_text(scratch / "b.png", "8BPS" + std::string(60, '\1'));
  EXPECT_NE(all_errors_of(scratch / "b.png").find("not a picture that can be read"), std::string::npos);
}

TEST(UltraHdr, TheBaseImageIsThePhotograph) {
  const ScratchDir scratch;
  write_photo(scratch / "base.jpg", made_up_photo(64, 48, 8, 4));
  write_photo(scratch / "gain.jpg", made_up_photo(16, 12, 8, 5));
  const std::string base = read_text(scratch / "base.jpg");
  // A gain map follows the picture's end; APP2 "MPF" says where.
  std::string both = base;
  both.insert(2, std::string("\xff\xe2\0\x08MPF\0\0\0", 10));
  both += read_text(scratch / "gain.jpg");
  write_text(scratch / "ultra.jpg", both);
  const Photo read = read_photo(scratch / "ultra.jpg"), plain = read_photo(scratch / "base.jpg");
  ASSERT_EQ(read.size(), (Size{64, 48}));
  EXPECT_EQ(differing_samples(std::get<0>(read.codes), std::get<0>(plain.codes)), 0);
}

}  // namespace
}  // namespace hdr
