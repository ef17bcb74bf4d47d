#include "libhdr/io/internal/pfm_file.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "libhdr/core/error.h"

namespace hdr::internal {
namespace {

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/// The next word; comments from # to the end of the line are passed over.
std::string next_word(std::string_view bytes, std::size_t& at) {
  while (at < bytes.size() && (is_space(bytes[at]) || bytes[at] == '#')) {
    if (bytes[at] == '#') {
      while (at < bytes.size() && bytes[at] != '\n') ++at;
    } else {
      ++at;
    }
  }
  const std::size_t begin = at;
  constexpr std::size_t kLongest = 64;
  while (at < bytes.size() && !is_space(bytes[at]) && at - begin < kLongest) ++at;
  return std::string(bytes.substr(begin, at - begin));
}

int side_of(const std::string& word, const std::string& name) {
  char* end = nullptr;
  const long value = std::strtol(word.c_str(), &end, 10);
  constexpr long kMost = 1 << 24;
  if (end == word.c_str() || *end != '\0' || value < 1 || value > kMost) {
    throw Error(fmt::format("{}: '{}' is no width or height; is it damaged?", name, word));
  }
  return static_cast<int>(value);
}

}  // namespace

PfmHeader parse_pfm_header(std::string_view bytes, const std::string& name) {
  std::size_t at = 0;
  const std::string magic = next_word(bytes, at);
  if (magic != "PF" && magic != "Pf") throw Error(name + ": does not begin with PF or Pf; it is no PFM");
  PfmHeader header;
  header.channels = magic == "PF" ? 3 : 1;
  header.width = side_of(next_word(bytes, at), name);
  header.height = side_of(next_word(bytes, at), name);
  const std::string scale = next_word(bytes, at);
  char* end = nullptr;
  const double value = std::strtod(scale.c_str(), &end);
  if (end == scale.c_str() || *end != '\0' || !std::isfinite(value) || value == 0) {
    throw Error(fmt::format("{}: its scale is '{}'; a PFM has -1.0 or 1.0 there", name, scale));
  }
  header.little_endian = value < 0;
  header.scale = std::abs(value);
  header.pixels_at = at + 1;  // one white space follows the scale
  const std::size_t row =
      sizeof(float) * static_cast<std::size_t>(header.channels) * static_cast<std::size_t>(header.width);
  const std::size_t there = bytes.size() > header.pixels_at ? bytes.size() - header.pixels_at : 0;
  if (there / row < static_cast<std::size_t>(header.height)) {
    throw Error(
        fmt::format("{}: cannot be read after row {} of {} (from the bottom): the file ends there; is it damaged?",
                    name, there / row, header.height));
  }
  return header;
}

void decode_pfm_row(std::string_view bytes, const PfmHeader& header, int y, float* samples) {
  const std::size_t count = static_cast<std::size_t>(header.channels) * static_cast<std::size_t>(header.width);
  const std::size_t row = static_cast<std::size_t>(header.height - 1 - y);
  std::memcpy(samples, bytes.data() + header.pixels_at + row * count * sizeof(float), count * sizeof(float));
  if (header.little_endian != (std::endian::native == std::endian::little)) {
    for (std::size_t k = 0; k < count; ++k) {
      samples[k] = std::bit_cast<float>(__builtin_bswap32(std::bit_cast<std::uint32_t>(samples[k])));
    }
  }
  if (header.scale == 1) return;
  for (std::size_t k = 0; k < count; ++k) samples[k] = static_cast<float>(samples[k] * header.scale);
}

}  // namespace hdr::internal
