#include "libhdr/io/internal/pfm_file.h"
#include "tests/fuzz/harness.h"

namespace hdr::fuzz {

std::vector<std::string> seeds() {
  return {"PF\n2 1\n-1.0\n" + std::string(24, 'x'), "Pf 1 3 2.5\n" + std::string(12, '\0'),
          "PF\n# a comment\n1 1\n1\n" + std::string(12, '\x3f')};
}

std::vector<std::string> extensions() {
  return {".pfm"};
}

}  // namespace hdr::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hdr;
  fuzz::expect_result_or_error([&] {
    const std::string_view bytes = fuzz::text_of(data, size);
    const internal::PfmHeader header = internal::parse_pfm_header(bytes, "input");
    std::vector<float> row(static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.channels));
    for (int y = 0; y < header.height; ++y) internal::decode_pfm_row(bytes, header, y, row.data());
  });
  return 0;
}
