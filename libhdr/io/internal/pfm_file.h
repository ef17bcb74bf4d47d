#pragma once
// Portable float maps: "PF" (three channels) or "Pf" (one), width, height, scale, then floats, the bottom row first. A
// negative scale means little endian; its size multiplies the samples.
#include <cstddef>
#include <string>
#include <string_view>

namespace hdr::internal {

struct PfmHeader {
  int width = 0, height = 0, channels = 3;
  bool little_endian = true;
  double scale = 1;
  std::size_t pixels_at = 0;
};

/// `bytes` is the whole file; `name` is for messages. Throws Error: no PFM, a size or scale that cannot be, fewer bytes
/// than the header promises (and how many rows there are).
PfmHeader parse_pfm_header(std::string_view bytes, const std::string& name);

/// Row y counted from the top, as floats of this machine. `bytes` are those that were parsed.
void decode_pfm_row(std::string_view bytes, const PfmHeader& header, int y, float* samples);

}  // namespace hdr::internal
