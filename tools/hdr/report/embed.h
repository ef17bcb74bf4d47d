#pragma once
// Data inside a page: bytes as base64, arrays of samples deflated first. Scripts read them back exactly.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libhdr/core/image.h"

namespace hdr::report {

/// [RFC 4648] 4, with padding.
std::string base64(std::string_view bytes);

/// zlib's stream [RFC 1950], what browsers call "deflate".
std::string deflated(std::string_view bytes);

/// A picture in linear light for scripts: `value = half x scale`, rounded to 8 significant bits: within .44 %, which is
/// finer than a step of an 8-bit screen. `scale` brings the largest value within halves. Not finite or negative is 0.
/// <script type="text/plain" id=ID data-kind="half" ...>; three channels.
std::string embedded_radiance(std::string_view id, View<const float> rgb);

/// One byte a pixel, or `channels` of them.
std::string embedded_bytes(std::string_view id, View<const std::uint8_t> bytes);

/// Layers of the same size one below the other, in one element with data-layers.
std::string embedded_levels(std::string_view id, const std::vector<Image<float>>& levels);

}  // namespace hdr::report
