// A camera's own JPEG: its picture is kept, byte for byte.
#include <gtest/gtest.h>

#include <span>

#include "libhdr/io/output_file.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/unit/io/io_test_support.h"

namespace hdr {
namespace {

using test::error_of;
using test::ScratchDir;
using Bytes = Image<std::uint8_t>;

std::span<const std::uint8_t> span_of(const std::string& bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

/// A JPEG as it lies on the disk.
std::string some_jpeg(const ScratchDir& scratch) {
  write_photo(scratch / "camera.jpg", test::made_up_photo(80, 60, 8, 1, {1.0, 22.0, 6400.0, 0}), 90);
  return read_text(scratch / "camera.jpg");
}

/// The frame that a camera of Motion JPEG streams: without the standard Huffman tables.
std::string without_tables(std::string jpeg) {
  for (std::size_t at = jpeg.find("\xff\xc4"); at != std::string::npos; at = jpeg.find("\xff\xc4", at)) {
    const std::size_t bytes =
        2 + 256 * static_cast<std::uint8_t>(jpeg[at + 2]) + static_cast<std::uint8_t>(jpeg[at + 3]);
    if (at > jpeg.find("\xff\xda")) break;
    jpeg.erase(at, bytes);
  }
  return jpeg;
}

TEST(StreamedJpeg, ReadsLikeTheFile) {
  const ScratchDir scratch;
  const std::string jpeg = some_jpeg(scratch);
  const Photo file = read_photo(scratch / "camera.jpg"),
              memory = photo_from_jpeg(span_of(jpeg + std::string(100, '\0')), "frame 7");
  EXPECT_TRUE(memory.lossy);
  EXPECT_EQ(memory.bits, 8);
  EXPECT_EQ(test::differing_samples(std::get<Bytes>(file.codes), std::get<Bytes>(memory.codes)), 0);
}

TEST(StreamedJpeg, IsWrittenWithAnotherExposureAndTheSamePicture) {
  const ScratchDir scratch;
  const std::string jpeg = some_jpeg(scratch);
  write_jpeg(scratch / "a.jpg", span_of(jpeg + std::string(37, '\0')), {1.0 / 250, std::nullopt, 100.0, 0});
  const Photo camera = read_photo(scratch / "camera.jpg"), kept = read_photo(scratch / "a.jpg");
  EXPECT_EQ(test::differing_samples(std::get<Bytes>(camera.codes), std::get<Bytes>(kept.codes)), 0);
  EXPECT_DOUBLE_EQ(kept.exposure.seconds.value_or(0), 1.0 / 250);
  EXPECT_FALSE(kept.exposure.f_number) << "the camera's own EXIF is replaced";
  EXPECT_DOUBLE_EQ(kept.exposure.iso.value_or(0), 100);
  const std::string written = read_text(scratch / "a.jpg");
  const std::string scan = jpeg.substr(jpeg.find("\xff\xda"));
  EXPECT_EQ(written.substr(written.size() - scan.size()), scan) << "not compressed again, and without padding";
}

TEST(StreamedJpeg, TablesThatAStreamLeavesOutAreTheStandardOnes) {
  const ScratchDir scratch;
  const std::string jpeg = some_jpeg(scratch), streamed = without_tables(jpeg);
  ASSERT_EQ(streamed.find("\xff\xc4"), std::string::npos);
  write_jpeg(scratch / "a.jpg", span_of(streamed), {0.01, std::nullopt, std::nullopt, 0});
  EXPECT_NE(read_text(scratch / "a.jpg").find("\xff\xc4"), std::string::npos) << "other programs need them in the file";
  const Photo camera = read_photo(scratch / "camera.jpg"), kept = read_photo(scratch / "a.jpg");
  EXPECT_EQ(test::differing_samples(std::get<Bytes>(camera.codes), std::get<Bytes>(kept.codes)), 0);
  const Photo memory = photo_from_jpeg(span_of(streamed), "frame 1");
  EXPECT_EQ(test::differing_samples(std::get<Bytes>(camera.codes), std::get<Bytes>(memory.codes)), 0);
}

TEST(StreamedJpeg, HalfAFrameIsRefused) {
  const ScratchDir scratch;
  const std::string jpeg = some_jpeg(scratch), half = jpeg.substr(0, jpeg.size() / 2);
  EXPECT_NE(error_of([&] { photo_from_jpeg(span_of(half), "frame 9"); }).find("frame 9: truncated"), std::string::npos);
  EXPECT_NE(error_of([&] { write_jpeg(scratch / "a.jpg", span_of(half), {}); }).find("truncated"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(scratch / "a.jpg"));
  EXPECT_NE(error_of([&] { photo_from_jpeg(span_of("no picture"), "frame 9"); }).find("not a JPEG"), std::string::npos);
}

}  // namespace
}  // namespace hdr
