// Any file that may be a map or a picture, the way `hdr info` and everything else reads them: what OpenImageIO's own
// readers would not survive must not come to them.
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/fuzz/harness.h"

namespace hdr::fuzz {

std::vector<std::string> seeds() {
  RadianceMap map;
  map.rgb = Image<float>(23, 18, 3);
  for (int y = 0; y < 18; ++y) {
    for (int k = 0; k < 69; ++k) map.rgb.row(y)[k] = static_cast<float>(0.01 * (k + 1) * (y + 1));
  }
  map.projection = "latlong";
  std::vector<std::string> all;
  const auto add = [&](const std::string& extension, const WriteOptions& options) {
    const InputFile file("", extension);
    write_map(file.path(), map, {}, options);
    std::ifstream in(file.path(), std::ios::binary);
    all.push_back({std::istreambuf_iterator<char>(in), {}});
  };
  for (const char* compression : {"none", "rle", "zip", "piz", "pxr24", "b44", "dwaa"}) {
    add(".exr", {SampleType::kHalf, compression, false});
  }
  for (const char* compression : {"none", "zip", "lzw", "pixarlog", "logluv", "logluv24", "logl"}) {
    add(".tif", {SampleType::kFloat, compression, false});
  }
  add(".hdr", {});
  add(".pfm", {});
  Photo photo;
  photo.codes = Image<std::uint8_t>(20, 9, 3);
  photo.exposure.seconds = 0.02;
  for (const char* extension : {".png", ".tif", ".jpg"}) {
    const InputFile file("", extension);
    write_photo(file.path(), photo);
    std::ifstream in(file.path(), std::ios::binary);
    all.push_back({std::istreambuf_iterator<char>(in), {}});
  }
  return all;
}

std::vector<std::string> extensions() {
  return {".exr", ".tif", ".pfm", ".jpg", ".png", ".hdr", ".dds"};
}

}  // namespace hdr::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hdr;
  const fuzz::InputFile file(fuzz::text_of(data, size), ".bin");  // by its bytes, not by its name
  fuzz::expect_result_or_error([&] { read_info(file.path()); });
  fuzz::expect_result_or_error([&] { read_map(file.path()); });
  fuzz::expect_result_or_error([&] { read_photo(file.path()); });
  return 0;
}
