#pragma once
// One input for a reader: whatever it is, the reader gives a result or throws hdr::Error. libFuzzer brings its own main
// (the `fuzz` preset); elsewhere plain_main.cpp replays seeds, files and seeded mutations of both, in ctest.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "libhdr/core/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace hdr::fuzz {

/// Small valid inputs.
std::vector<std::string> seeds();

/// Extensions of files that are inputs of this reader, with the dot; for the replay of collections.
std::vector<std::string> extensions();

/// Runs `read`; an Error must be one line that says something, anything else thrown is a bug.
template <class Read>
void expect_result_or_error(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    const std::string_view what = error.what();
    if (what.empty() || what.find('\n') != std::string_view::npos) {
      std::fprintf(stderr, "an Error of another form: '%s'\n", error.what());
      std::abort();
    }
  }
}

/// The input as a file, for readers that want one; the same name each time.
class InputFile {
 public:
  InputFile(std::string_view bytes, const std::string& extension)
      : path_(std::filesystem::temp_directory_path() / ("hdr-fuzz-" + std::to_string(getpid()) + extension)) {
    std::ofstream(path_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace hdr::fuzz
