#include "libhdr/io/internal/radiance_file.h"
#include "tests/fuzz/harness.h"

namespace hdr::fuzz {

std::vector<std::string> seeds() {
  const std::string head =
      "#?RADIANCE\nEXPOSURE=2\nPRIMARIES=.64 .33 .29 .6 .15 .06 .333 .333\nFORMAT=32-bit_rle_rgbe\n\n";
  const std::string pixel = "\x80\x40\x20\x81";
  std::string runs;
  for (int y = 0; y < 2; ++y) {
    runs += std::string("\2\2\0\x0a", 4);
    for (int c = 0; c < 4; ++c) runs += std::string("\x84\x80\6abcdef", 9);
  }
  return {head + "-Y 2 +X 2\n" + pixel + pixel + pixel + pixel, head + "-Y 2 +X 10\n" + runs,
          "#?RGBE\n\n+X 1 -Y 9\n" + pixel + std::string("\1\1\1\x8\x80\x40\x20\x81", 8)};
}

std::vector<std::string> extensions() {
  return {".hdr", ".pic"};
}

}  // namespace hdr::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hdr;
  fuzz::expect_result_or_error([&] {
    const std::string_view bytes = fuzz::text_of(data, size);
    const internal::RadianceHeader header = internal::parse_radiance_header(bytes, "input");
    // As the reader does: what a file of this size cannot hold is refused before a row is made.
    if (1.0 * header.length * header.scanlines > 65536.0 * static_cast<double>(size)) return;
    internal::RadianceScanlines scanlines(bytes, header, Mantissa::kPlain, "input");
    std::vector<float> row(3 * static_cast<std::size_t>(header.length));
    while (scanlines.done() < header.scanlines) scanlines.next(row.data());
  });
  return 0;
}
