#include "libhdr/core/mosaic.h"
#include "libhdr/io/dng.h"
#include "libhdr/io/read.h"
#include "tests/fuzz/harness.h"

namespace hdr::fuzz {

std::vector<std::string> seeds() {
  const InputFile file("", ".dng");
  Mosaic mosaic;
  mosaic.codes = Image<std::uint16_t>(16, 12, 1);
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 16; ++x) mosaic.codes(x, y) = static_cast<std::uint16_t>(64 + 200 * x + 13 * y);
  }
  mosaic.cfa = Cfa::kRggb;
  mosaic.white_level = 4095;
  mosaic.exposure.seconds = 0.01;
  write_dng(file.path(), mosaic, "fuzz");
  std::ifstream in(file.path(), std::ios::binary);
  return {{std::istreambuf_iterator<char>(in), {}}};
}

std::vector<std::string> extensions() {
  return {".dng"};
}

}  // namespace hdr::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hdr;
  const fuzz::InputFile file(fuzz::text_of(data, size), ".dng");
  fuzz::expect_result_or_error([&] { read_photo(file.path()); });
  return 0;
}
