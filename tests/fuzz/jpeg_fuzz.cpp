// JPEG as cameras stream it, in memory.
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/fuzz/harness.h"

namespace hdr::fuzz {

std::vector<std::string> seeds() {
  const InputFile file("", ".jpg");
  Photo photo;
  Image<std::uint8_t> codes(24, 17, 3);
  for (int y = 0; y < 17; ++y) {
    for (int k = 0; k < 72; ++k) codes.row(y)[k] = static_cast<std::uint8_t>(3 * k + 5 * y);
  }
  photo.codes = std::move(codes);
  photo.exposure.seconds = 0.01;
  write_photo(file.path(), photo);
  std::ifstream in(file.path(), std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  // The same with a colour profile, as OpenImageIO 2.4 reads and trusts it.
  std::string profile = "ICC_PROFILE";
  profile +=
      std::string("\0\1\1", 3) + std::string("\0\0\0\xa8lcms\4\x30\0\0mntrRGB XYZ ", 24) + std::string(104, '\0');
  profile += std::string("\0\0\0\2desc\0\0\0\x98\0\0\0\x10wtpt\0\0\0\x98\0\0\0\x10", 28) + std::string(16, '\1');
  const std::size_t length = profile.size() + 2;
  const std::string segment =
      std::string("\xff\xe2") + static_cast<char>(length >> 8) + static_cast<char>(length & 255) + profile;
  std::string with_profile = bytes;
  with_profile.insert(2, segment);
  return {bytes, with_profile};
}

std::vector<std::string> extensions() {
  return {".jpg"};
}

}  // namespace hdr::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  hdr::fuzz::expect_result_or_error([&] { hdr::photo_from_jpeg({data, size}, "input"); });
  return 0;
}
