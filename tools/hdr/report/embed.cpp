#include "tools/hdr/report/embed.h"

#include <Imath/half.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "tools/hdr/report/html.h"

namespace hdr::report {
namespace {

constexpr float kMostHalf = 65504;

/// A half with 7 bits of mantissa: the three lowest bits 0, ties to even.
std::uint16_t coarse_half(float value) {
  constexpr unsigned kStep = 1u << 3, kInfinity = 0x7C00u;
  const unsigned bits = Imath::half(std::min(value, kMostHalf)).bits();
  const unsigned rounded = (bits + kStep / 2 - 1 + ((bits / kStep) & 1)) & ~(kStep - 1);
  return static_cast<std::uint16_t>(rounded >= kInfinity ? kInfinity - kStep : rounded);
}

float light(float value) {
  return std::isfinite(value) && value > 0 ? value : 0.0f;
}

float largest(View<const float> rgb) {
  float most = 0;
  for (int y = 0; y < rgb.height(); ++y) {
    const float* row = rgb.row(y);
    for (int k = 0; k < rgb.width() * rgb.channels(); ++k) most = std::max(most, light(row[k]));
  }
  return most;
}

/// Appends the rows: for each a plane of high bytes and one of low bytes, each byte less the one before it of the same
/// channel. Smooth pictures become runs of small numbers, as in OpenEXR's ZIP.
void append_rows(std::string& out, View<const float> rgb, float scale) {
  const int channels = rgb.channels(), samples = rgb.width() * channels;
  std::vector<std::uint16_t> codes(static_cast<std::size_t>(samples));
  for (int y = 0; y < rgb.height(); ++y) {
    const float* row = rgb.row(y);
    for (int k = 0; k < samples; ++k) codes[static_cast<std::size_t>(k)] = coarse_half(light(row[k]) / scale);
    for (const int shift : {8, 0}) {
      for (int c = 0; c < channels; ++c) {
        int before = 0;
        for (int k = c; k < samples; k += channels) {
          const int byte = (codes[static_cast<std::size_t>(k)] >> shift) & 0xFF;
          out += static_cast<char>((byte - before) & 0xFF);
          before = byte;
        }
      }
    }
  }
}

std::string script_element(std::string_view id, const std::string& attributes, const std::string& bytes) {
  return fmt::format("<script type=\"text/plain\" id=\"{}\" {}>{}</script>\n", escaped(id), attributes,
                     base64(deflated(bytes)));
}

std::string halves(std::string_view id, const std::vector<View<const float>>& layers) {
  HDR_ASSERT(!layers.empty());
  float most = 0;
  for (const View<const float>& layer : layers) {
    HDR_ASSERT(layer.size() == layers[0].size() && layer.channels() == layers[0].channels());
    most = std::max(most, largest(layer));
  }
  // A power of two, so that values that halves hold stay as they are.
  const float scale = most > kMostHalf ? std::exp2(std::ceil(std::log2(most / kMostHalf))) : 1.0f;
  std::string bytes;
  for (const View<const float>& layer : layers) append_rows(bytes, layer, scale);
  return script_element(id,
                        fmt::format("data-kind=\"half\" data-width=\"{}\" data-height=\"{}\" data-channels=\"{}\" "
                                    "data-layers=\"{}\" data-scale=\"{}\"",
                                    layers[0].width(), layers[0].height(), layers[0].channels(), layers.size(), scale),
                        bytes);
}

}  // namespace

std::string base64(std::string_view bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const auto byte = [&](std::size_t i) {
      return i < bytes.size() ? static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])) : 0u;
    };
    const std::uint32_t group = byte(k) << 16 | byte(k + 1) << 8 | byte(k + 2);
    out += kDigits[group >> 18];
    out += kDigits[(group >> 12) & 63];
    out += k + 1 < bytes.size() ? kDigits[(group >> 6) & 63] : '=';
    out += k + 2 < bytes.size() ? kDigits[group & 63] : '=';
  }
  return out;
}

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  const int code = compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                             static_cast<uLong>(bytes.size()), Z_BEST_COMPRESSION);
  HDR_ASSERT(code == Z_OK);
  out.resize(size);
  return out;
}

std::string embedded_radiance(std::string_view id, View<const float> rgb) {
  return halves(id, {rgb});
}

std::string embedded_levels(std::string_view id, const std::vector<Image<float>>& levels) {
  std::vector<View<const float>> views;
  for (const Image<float>& level : levels) views.push_back(level.view());
  return halves(id, views);
}

std::string embedded_bytes(std::string_view id, View<const std::uint8_t> bytes) {
  std::string rows;
  for (int y = 0; y < bytes.height(); ++y) {
    rows.append(reinterpret_cast<const char*>(bytes.row(y)),
                static_cast<std::size_t>(bytes.width()) * static_cast<std::size_t>(bytes.channels()));
  }
  return script_element(id,
                        fmt::format("data-kind=\"bytes\" data-width=\"{}\" data-height=\"{}\" data-channels=\"{}\"",
                                    bytes.width(), bytes.height(), bytes.channels()),
                        rows);
}

}  // namespace hdr::report
