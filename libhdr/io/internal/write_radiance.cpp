#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/version.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/rec709.h"
#include "libhdr/io/internal/rgbe.h"
#include "libhdr/io/internal/write_own.h"

namespace hdr::internal {
namespace {

std::string header_text(const MapHeader& map) {
  std::string text = fmt::format("#?RADIANCE\nSOFTWARE=hdr {}\n", kVersion);
  if (const Chromaticities& xy = map.chromaticities; !is_rec709(xy)) {
    text += fmt::format("PRIMARIES={} {} {} {} {} {} {} {}\n", xy.red[0], xy.red[1], xy.green[0], xy.green[1],
                        xy.blue[0], xy.blue[1], xy.white[0], xy.white[1]);
  }
  if (map.white_luminance) text += fmt::format("hdr:whiteLuminance={}\n", *map.white_luminance);
  if (!map.projection.empty()) text += fmt::format("hdr:projection={}\n", map.projection);
  return text + fmt::format("FORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", map.size.height, map.size.width);
}

/// One component of a scanline: runs of at least four as (128 + count, value), what lies between as (count, values).
void append_runs(const std::uint8_t* values, std::size_t length, std::string& out) {
  constexpr std::size_t kMinRun = 4, kMaxRun = 127, kMaxLiteral = 128;
  for (std::size_t at = 0; at < length;) {
    std::size_t run_at = at, run = 0;
    while (run_at < length) {  // the next run worth its two bytes
      run = 1;
      while (run < kMaxRun && run_at + run < length && values[run_at + run] == values[run_at]) ++run;
      if (run >= kMinRun) break;
      run_at += run;
    }
    const std::size_t literals_end = std::min(run_at, length);
    while (at < literals_end) {
      const std::size_t count = std::min(kMaxLiteral, literals_end - at);
      out += static_cast<char>(count);
      out.append(reinterpret_cast<const char*>(values + at), count);
      at += count;
    }
    if (run_at >= length) break;
    out += static_cast<char>(128 + run);
    out += static_cast<char>(values[run_at]);
    at = run_at + run;
  }
}

std::string encoded(const float* rgb, int width) {
  const auto length = static_cast<std::size_t>(width);
  std::string out;
  constexpr int kShortest = 8, kLongest = 0x7fff;  // lengths that the run-length encoding is for
  if (width < kShortest || width > kLongest) {
    for (std::size_t x = 0; x < length; ++x) {
      const Rgbe code = rgbe_from_rgb(rgb + 3 * x);
      out.append(reinterpret_cast<const char*>(code.data()), code.size());
    }
    return out;
  }
  std::vector<std::uint8_t> planes(4 * length);
  for (std::size_t x = 0; x < length; ++x) {
    const Rgbe code = rgbe_from_rgb(rgb + 3 * x);
    for (std::size_t c = 0; c < 4; ++c) planes[c * length + x] = code[c];
  }
  out.reserve(4 * length + length / 16 + 16);
  out = {2, 2, static_cast<char>(width >> 8), static_cast<char>(width & 255)};
  for (std::size_t c = 0; c < 4; ++c) append_runs(planes.data() + c * length, length, out);
  return out;
}

class RadianceOut final : public RowsOut {
 public:
  RadianceOut(const Path& file, const Path& path, const MapHeader& header) : path_(path), out_(file, std::ios::binary) {
    out_ << header_text(header);
    if (!out_) throw_unwritable(path_, "the header did not fit");
  }
  void put(View<float> rows) override {
    std::vector<std::string> encoded_rows(static_cast<std::size_t>(rows.height()));
    for_rows(rows.height(), 8, [&](int first, int last) {
      for (int y = first; y < last; ++y) {
        require_fit(rows, y);
        encoded_rows[static_cast<std::size_t>(y)] = encoded(rows.row(y), rows.width());
      }
    });
    for (const std::string& row : encoded_rows) out_ << row;
  }
  void finish() override {
    out_.close();
    if (!out_) throw_unwritable(path_, "the pixels did not fit");
  }

 private:
  void require_fit(View<const float> rows, int y) const {
    for (int k = 0; k < 3 * rows.width(); ++k) {
      if (rows.row(y)[k] <= kRgbeLargest) continue;
      throw Error(fmt::format("{}: cannot be written: the value {:g} is beyond RGBE; write .exr", path_.string(),
                              rows.row(y)[k]));
    }
  }

  Path path_;
  std::ofstream out_;
};

}  // namespace

std::unique_ptr<RowsOut> write_radiance(const Path& file, const Path& path, const MapHeader& header) {
  return std::make_unique<RadianceOut>(file, path, header);
}

}  // namespace hdr::internal
