// Rows that are decoded as they are asked for are those of the whole picture, whatever the file and the window.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "libhdr/core/parallel.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

using test::error_of;
using test::made_up_photo;
using test::ScratchDir;

/// Samples that differ between rows first .. last - 1 of `photo` and `view`.
std::int64_t differing(const Photo& photo, const CodesView& view, int first, int last) {
  std::int64_t count = 0;
  std::visit(
      [&](const auto& image) {
        using Code = std::remove_cvref_t<decltype(image(0, 0))>;
        const auto& band = std::get<View<const Code>>(view);
        EXPECT_EQ(band.height(), last - first);
        for (int y = first; y < last; ++y) {
          for (int k = 0; k < 3 * band.width(); ++k) count += image.row(y)[k] != band.row(y - first)[k];
        }
      },
      photo.codes);
  return count;
}

/// Bands of 7 rows with a margin of 3 on either side, as a merge of moved shots asks for them; then with a gap.
void expect_rows_of(const Path& path, std::optional<Size> top_left = std::nullopt) {
  const Photo whole = read_photo(path);
  const auto rows = open_photo_rows(path, top_left);
  const Size size = top_left.value_or(whole.size());
  ASSERT_EQ(rows->size(), size) << path;
  for (int y = 0; y < size.height; y += 7) {
    const int first = std::max(0, y - 3), last = std::min(size.height, y + 10);
    ASSERT_EQ(differing(whole, rows->rows(first, last), first, last), 0) << path << ", rows from " << first;
  }
  if (size.height < 6) return;
  const auto others = open_photo_rows(path, top_left);
  const int third = size.height / 3;
  for (const auto& [first, last] : {std::pair{0, third / 2},
                                    {third, third + 1},
                                    {third + 1, third + 1},
                                    {2 * third, size.height},
                                    {size.height, size.height}}) {
    ASSERT_EQ(differing(whole, others->rows(first, last), first, last), 0) << path << ", rows from " << first;
  }
}

TEST(PhotoRows, AreThoseOfTheWholePicture) {
  const ScratchDir scratch;
  for (const char* name : {"a.jpg", "a.png", "a.tif"}) {
    write_photo(scratch / name, made_up_photo(83, 150, 8, 1));
    expect_rows_of(scratch / name);
    expect_rows_of(scratch / name, Size{70, 149});
  }
  for (const char* name : {"a16.png", "a16.tif"}) {
    write_photo(scratch / name, made_up_photo(83, 150, 16, 2));
    expect_rows_of(scratch / name);
    expect_rows_of(scratch / name, Size{1, 1});
  }
}

/// Writes noise with OpenImageIO, so that anything may be asked of the file.
void write_raw(const Path& path, OIIO::ImageSpec spec) {
  spec.attribute("oiio:UnassociatedAlpha", 1);
  Random random(5, 0);
  std::vector<std::uint8_t> bytes(spec.image_bytes());
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.bits());
  const auto out = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(out->open(path.string(), spec)) << out->geterror();
  ASSERT_TRUE(out->write_image(spec.format, bytes.data()) && out->close()) << out->geterror();
}

TEST(PhotoRows, GreyAlphaAndTiles) {
  const ScratchDir scratch;
  for (const OIIO::TypeDesc type : {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16}) {
    for (const int channels : {1, 2, 3, 4}) {
      for (const char* name : {"a.png", "a.tif"}) {
        write_raw(scratch / name, {45, 61, channels, type});
        expect_rows_of(scratch / name);
        expect_rows_of(scratch / name, Size{30, 60});
      }
      OIIO::ImageSpec tiled(45, 61, channels, type);
      tiled.tile_width = tiled.tile_height = 16;
      write_raw(scratch / "tiled.tif", tiled);
      expect_rows_of(scratch / "tiled.tif");
    }
  }
  write_raw(scratch / "a.bmp", {45, 61, 3, OIIO::TypeDesc::UINT8});
  expect_rows_of(scratch / "a.bmp");
}

TEST(PhotoRows, EveryOrientationUprightAndCropped) {
  const ScratchDir scratch;
  for (int orientation = 1; orientation <= 8; ++orientation) {
    for (const OIIO::TypeDesc type : {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16}) {
      OIIO::ImageSpec spec(150, 131, 3, type);  // more rows than a strip either way
      spec.attribute("Orientation", orientation);
      write_raw(scratch / "a.tif", spec);
      expect_rows_of(scratch / "a.tif");
      expect_rows_of(scratch / "a.tif", Size{120, 129});
    }
  }
}

TEST(PhotoRows, ProgressiveJpeg) {
  const ScratchDir scratch;
  OIIO::ImageSpec spec(120, 90, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("jpeg:progressive", 1);
  write_raw(scratch / "a.jpg", spec);
  ASSERT_NE(read_text(scratch / "a.jpg").find("\xff\xc2"), std::string::npos) << "the writer made no progressive JPEG";
  expect_rows_of(scratch / "a.jpg");
}

TEST(PhotoRows, ADamagedFileSaysWhereItEnds) {
  const ScratchDir scratch;
  for (const std::string extension : {".png", ".tif"}) {
    const Path whole = scratch / ("whole" + extension), cut = scratch / ("cut" + extension);
    write_photo(whole, made_up_photo(200, 150, 8, 10));
    const std::string bytes = read_text(whole);
    std::string damaged = bytes.substr(0, bytes.size() * 6 / 10);
    if (extension == ".tif") {  // the directory stands at the end: damage a strip instead
      damaged = bytes;
      std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2), bytes.size() / 8, '\xff');
    }
    write_text(cut, damaged);
    const std::string streamed = error_of([&] {
      const auto rows = open_photo_rows(cut);
      for (int y = 0; y < 150; ++y) rows->rows(y, y + 1);
    });
    EXPECT_TRUE(streamed.starts_with(cut.string() + ": cannot be read after row ")) << extension << ": " << streamed;
    EXPECT_NE(streamed.find(" of 150: "), std::string::npos) << extension << ": " << streamed;
    EXPECT_EQ(streamed.find('\n'), std::string::npos) << extension << ": " << streamed;
    EXPECT_EQ(error_of([&] { read_photo(cut); }), streamed) << "decoded whole, it says the same";
  }
  const Path cut = scratch / "cut.jpg";
  write_photo(cut, made_up_photo(200, 150, 8, 10));
  write_text(cut, read_text(cut).substr(0, 5000));
  EXPECT_NE(error_of([&] { open_photo_rows(cut); }).find("cut.jpg: truncated"), std::string::npos);
}

TEST(PhotoRows, ObjectsWorkSideBySide) {
  const ScratchDir scratch;
  constexpr int kShots = 12;
  for (int k = 0; k < kShots; ++k) {
    write_photo(scratch / (std::to_string(k) + ".jpg"), made_up_photo(90, 120, 8, static_cast<std::uint64_t>(k)));
  }
  for_rows(kShots, 1, [&](int k, int) { expect_rows_of(scratch / (std::to_string(k) + ".jpg")); });
}

TEST(PhotoRows, APhotoWithoutCodesGivesThemBack) {
  const ScratchDir scratch;
  write_photo(scratch / "a.png", made_up_photo(50, 40, 16, 3));
  const Photo whole = read_photo(scratch / "a.png");
  Photo bare{whole.path, whole.exposure, whole.bits, whole.lossy, {}, {}};
  EXPECT_EQ(bare.size(), Size{}) << "neither codes nor a source";
  EXPECT_EQ(rows_of(bare)->size(), Size{});
  bare.source = {whole.size(), [&] { return open_photo_rows(scratch / "a.png"); }};
  EXPECT_FALSE(bare.in_memory());
  EXPECT_EQ(bare.size(), whole.size());
  EXPECT_EQ(differing(whole, rows_of(bare)->rows(0, 40), 0, 40), 0);
  const LoadedShot loaded(bare);
  ASSERT_TRUE(loaded->in_memory());
  EXPECT_EQ(differing(whole, rows_of(*loaded)->rows(0, 40), 0, 40), 0);
  EXPECT_FALSE(bare.in_memory());
  EXPECT_EQ(&*LoadedShot(whole), &whole) << "codes in memory are not copied";
}

}  // namespace
}  // namespace hdr
