#include "libhdr/response/response.h"
#include "libhdr/response/response_file.h"
#include "tests/fuzz/harness.h"

namespace hdr::fuzz {

std::vector<std::string> seeds() {
  std::vector<std::string> all;
  const Response gamma = response_from_name("gamma:2.2", 8).value();
  for (const char* name : {"r.json", "r.m", "r.csv"})
    all.push_back(std::string(name) + '\n' + text_from_response(gamma, name));
  return all;
}

std::vector<std::string> extensions() {
  return {};
}

}  // namespace hdr::fuzz

/// The first line names the file, whose extension says how to read the rest.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace hdr;
  const std::string text(fuzz::text_of(data, size));
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string body = end < text.size() ? text.substr(end + 1) : "";
  const std::string extension =
      std::filesystem::path(text.substr(0, std::min<std::size_t>(end, 60))).extension().string();
  fuzz::expect_result_or_error(
      [&] { response_from_text(body, "input" + (extension == ".m" || extension == ".csv" ? extension : ".json"), 8); });
  return 0;
}
