#include "libhdr/io/internal/radiance_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <utility>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/rgbe.h"

namespace hdr::internal {
namespace {

constexpr std::size_t kLongestHeader = 1 << 20;

std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream stream(text);
  for (double number = 0; stream >> number;) numbers.push_back(number);
  return numbers;
}

bool is_factor(double value) {
  return std::isfinite(value) && value > 0;
}

/// One line of the header, KEY=VALUE; what is not known is passed over, as Radiance does.
void take_line(const std::string& line, RadianceHeader& header, const std::string& name) {
  const std::size_t equals = line.find('=');
  if (equals == std::string::npos) return;
  const std::string key = line.substr(0, equals), value = line.substr(equals + 1);
  const std::vector<double> numbers = numbers_in(value);
  if (key == "FORMAT") {
    header.xyz = value.find("32-bit_rle_xyze") != std::string::npos;
    if (!header.xyz && value.find("32-bit_rle_rgbe") == std::string::npos) {
      throw Error(fmt::format("{}: FORMAT={} is not a picture in RGBE or XYZE; convert it with Radiance", name, value));
    }
  } else if (key == "EXPOSURE") {
    if (!numbers.empty() && is_factor(numbers[0])) header.exposure *= numbers[0];
  } else if (key == "COLORCORR") {
    for (std::size_t c = 0; numbers.size() == 3 && c < 3; ++c) {
      if (is_factor(numbers[c])) header.color_correction[c] *= numbers[c];
    }
  } else if (key == "PRIMARIES" && numbers.size() == 8) {
    Chromaticities xy;
    for (std::size_t i = 0; i < 2; ++i) {
      xy.red[i] = static_cast<float>(numbers[i]);
      xy.green[i] = static_cast<float>(numbers[2 + i]);
      xy.blue[i] = static_cast<float>(numbers[4 + i]);
      xy.white[i] = static_cast<float>(numbers[6 + i]);
    }
    header.primaries = xy;
  } else if (key == "hdr:projection") {
    header.projection = value;
  } else if (key == "hdr:whiteLuminance" && !numbers.empty() && is_factor(numbers[0])) {
    header.white_luminance = numbers[0];
  }
}

/// "-Y 512 +X 768": the axis that changes from scanline to scanline first, Y upwards. EXIF counts where row 0 and
/// column 0 of the file lie: 1 top left, 2 top right, 3 bottom right, 4 bottom left, 5 left top, 6 right top, 7 right
/// bottom, 8 left bottom.
void take_resolution(const std::string& line, RadianceHeader& header, const std::string& name) {
  static constexpr std::pair<const char*, int> kForms[] = {{"-Y+X", 1}, {"-Y-X", 2}, {"+Y-X", 3}, {"+Y+X", 4},
                                                           {"+X-Y", 5}, {"-X-Y", 6}, {"-X+Y", 7}, {"+X+Y", 8}};
  std::string slow, fast;
  long scanlines = 0, length = 0;
  std::istringstream stream(line);
  const bool read = static_cast<bool>(stream >> slow >> scanlines >> fast >> length);
  for (const auto& [form, orientation] : kForms) {
    if (!read || slow + fast != form) continue;
    constexpr long kMost = 1 << 24;
    if (scanlines < 1 || length < 1 || scanlines > kMost || length > kMost) break;
    header.scanlines = static_cast<int>(scanlines);
    header.length = static_cast<int>(length);
    header.orientation = orientation;
    return;
  }
  throw Error(
      fmt::format("{}: '{}' is no resolution such as -Y 512 +X 1024; is it damaged?", name, line.substr(0, 40)));
}

}  // namespace

RadianceHeader parse_radiance_header(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("#?")) throw Error(name + ": does not begin with #?; it is no Radiance picture");
  RadianceHeader header;
  bool in_header = true;
  for (std::size_t at = 0; at < std::min(bytes.size(), kLongestHeader);) {
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string_view::npos) break;
    std::string line(bytes.substr(at, end - at));
    if (line.ends_with('\r')) line.pop_back();
    at = end + 1;
    if (!in_header) {
      take_resolution(line, header, name);
      header.pixels_at = at;
      return header;
    }
    if (line.empty()) {
      in_header = false;
    } else if (!line.starts_with('#')) {
      take_line(line, header, name);
    }
  }
  throw Error(name + ": its header has no end; is it damaged?");
}

RadianceScanlines::RadianceScanlines(std::string_view bytes, const RadianceHeader& header, Mantissa mantissa,
                                     std::string name)
    : bytes_(bytes),
      header_(header),
      name_(std::move(name)),
      at_(header.pixels_at),
      offset_(mantissa == Mantissa::kMiddle ? 0.5 : 0.0) {
  for (std::size_t c = 0; c < 3; ++c) divisor_[c] = header.exposure * header.color_correction[c];
}

void RadianceScanlines::fail(const char* what) const {
  throw Error(
      fmt::format("{}: cannot be read after row {} of {}: {}; is it damaged?", name_, done_, header_.scanlines, what));
}

std::uint8_t RadianceScanlines::byte() {
  if (at_ >= bytes_.size()) fail("the file ends there");
  return static_cast<std::uint8_t>(bytes_[at_++]);
}

void RadianceScanlines::next(float* samples) {
  const auto length = static_cast<std::size_t>(header_.length);
  codes_.resize(4 * length);
  read_codes();
  const std::uint8_t *exponent = codes_.data() + 3 * length, *mantissa = codes_.data();
  const bool exact = divisor_ == std::array{1.0, 1.0, 1.0} && offset_ == 0;
  for (std::size_t x = 0; x < length; ++x, samples += 3) {
    const float scale = rgbe_scales()[exponent[x]];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint8_t m = mantissa[c * length + x];
      samples[c] = exact ? m * scale : static_cast<float>((m + offset_) * scale / divisor_[c]);
    }
  }
  ++done_;
}

void RadianceScanlines::read_codes() {
  constexpr int kShortest = 8, kLongest = 0x7fff;  // lengths that the new encoding is for
  if (header_.length < kShortest || header_.length > kLongest) return read_old();
  if (at_ + 4 > bytes_.size()) fail("the file ends there");
  const auto at = [&](std::size_t k) { return static_cast<std::uint8_t>(bytes_[at_ + k]); };
  if (at(0) != 2 || at(1) != 2 || (at(2) & 0x80) != 0) return read_old();
  if ((at(2) << 8 | at(3)) != header_.length) fail("a scanline of another length");
  at_ += 4;
  read_runs();
}

/// Pixels as they are; 1 1 1 n repeats the one before n times, and n 2^8 times when another such pixel follows, ...
void RadianceScanlines::read_old() {
  const auto length = static_cast<std::size_t>(header_.length);
  int shift = 0;
  for (std::size_t x = 0; x < length;) {
    if (at_ + 4 > bytes_.size()) fail("the file ends there");
    const std::string_view code = bytes_.substr(at_, 4);
    at_ += 4;
    if (code[0] != 1 || code[1] != 1 || code[2] != 1) {
      for (std::size_t c = 0; c < 4; ++c) codes_[c * length + x] = static_cast<std::uint8_t>(code[c]);
      ++x;
      shift = 0;
      continue;
    }
    const std::size_t count = static_cast<std::size_t>(static_cast<std::uint8_t>(code[3])) << shift;
    if (x == 0 && count > 0) fail("a run that repeats no pixel");
    if (count > length - x) fail("a run beyond the end of its scanline");
    for (std::size_t c = 0; c < 4 && count > 0; ++c) {
      std::uint8_t* to = codes_.data() + c * length + x;
      std::fill_n(to, count, to[-1]);
    }
    x += count;
    if (shift <= 16) shift += 8;
  }
}

/// Four components one after the other, each as runs (count + 128, value) and literals (count, values).
void RadianceScanlines::read_runs() {
  const auto length = static_cast<std::size_t>(header_.length);
  for (std::size_t component = 0; component < 4; ++component) {
    std::uint8_t* to = codes_.data() + component * length;
    for (std::size_t x = 0; x < length;) {
      const std::uint8_t code = byte();
      const bool is_run = code > 128;
      const std::size_t count = is_run ? code - 128u : code;
      if (count == 0) fail("a run of no length");
      if (count > length - x) fail("a run beyond the end of its scanline");
      if (is_run) {
        std::fill_n(to + x, count, byte());
      } else {
        if (at_ + count > bytes_.size()) fail("the file ends there");
        std::copy_n(bytes_.data() + at_, count, reinterpret_cast<char*>(to + x));
        at_ += count;
      }
      x += count;
    }
  }
}

}  // namespace hdr::internal
