#include "libhdr/io/exposure_list.h"
#include "tests/fuzz/harness.h"

namespace hdr::fuzz {

std::vector<std::string> seeds() {
  return {"a.jpg 1/250 5.6 100 2\nb.jpg 0.5\n", "# name 1/shutter_speed f gain nd\nmemorial0061.ppm 0.03125 8 0 0\n",
          "\"with space.jpg\" 2\n/a/b.jpg 60 5.6 100 0\n"};
}

std::vector<std::string> extensions() {
  return {".txt", ".tsv", ".hdrgen"};
}

}  // namespace hdr::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hdr;
  const std::string text(fuzz::text_of(data, size));
  for (const ListFormat format : {ListFormat::kAuto, ListFormat::kSeconds, ListFormat::kInverse}) {
    fuzz::expect_result_or_error([&] { parse_exposure_list(text, "input", format); });
  }
  return 0;
}
