#pragma once
// Radiance pictures (.hdr, .pic), read as Radiance's own header.c, resolu.c and color.c read them [Ward91].
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libhdr/core/radiance.h"
#include "libhdr/io/read.h"

namespace hdr::internal {

struct RadianceHeader {
  int scanlines = 0, length = 0;  ///< as stored: scanlines may be columns
  int orientation = 1;            ///< EXIF's number of the resolution string's eight forms
  bool xyz = false;               ///< FORMAT=32-bit_rle_xyze
  /// Products of the EXPOSURE and COLORCORR lines, by which the pixels are to be divided.
  double exposure = 1;
  std::array<double, 3> color_correction{1, 1, 1};
  std::optional<Chromaticities> primaries;
  std::optional<double> white_luminance;  ///< our own line, hdr:whiteLuminance=
  std::string projection;                 ///< our own line, hdr:projection=
  std::size_t pixels_at = 0;              ///< bytes before the first scanline
};

/// `name` is for messages. A header without FORMAT is taken for RGBE, as Radiance does. Throws Error: no Radiance file,
/// another FORMAT, no resolution line, a header without end.
RadianceHeader parse_radiance_header(std::string_view bytes, const std::string& name);

/// The scanlines one after the other: flat, or run-length encoded in the old way or the new one, scanline by scanline.
class RadianceScanlines {
 public:
  /// `bytes` of the whole file must outlive this.
  RadianceScanlines(std::string_view bytes, const RadianceHeader& header, Mantissa mantissa, std::string name);
  /// Decodes the next one into 3 x length samples, RGB or XYZ. Throws Error that names the scanline.
  void next(float* samples);
  int done() const { return done_; }

 private:
  [[noreturn]] void fail(const char* what) const;
  std::uint8_t byte();
  void read_codes();
  void read_old();
  void read_runs();

  std::string_view bytes_;
  RadianceHeader header_;
  std::string name_;
  std::size_t at_;
  int done_ = 0;
  std::vector<std::uint8_t> codes_;  ///< the scanline's reds, then its greens, blues and exponents
  double offset_;                    ///< added to a mantissa
  std::array<double, 3> divisor_;
};

}  // namespace hdr::internal
