#include "capture/appearance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "capture/develop.h"
#include "capture/internal/unpack.h"
#include "libhdr/core/error.h"

namespace hdr {
namespace {

/// Adds up codes in tiles, whose mean has little noise.
class Tiles {
 public:
  explicit Tiles(Size size)
      : size_(size),
        columns_(std::clamp(size.width / 8, 1, 24)),
        rows_(std::clamp(size.height / 8, 1, 18)),
        sums_(static_cast<std::size_t>(columns_ * rows_)),
        counts_(sums_.size()) {}

  void add(int x, int y, double code) {
    const auto tile = static_cast<std::size_t>(y * rows_ / size_.height * columns_ + x * columns_ / size_.width);
    sums_[tile] += code;
    ++counts_[tile];
  }

  std::vector<float> means() const {
    std::vector<float> means(sums_.size());
    for (std::size_t k = 0; k < means.size(); ++k) {
      means[k] = static_cast<float>(counts_[k] ? sums_[k] / static_cast<double>(counts_[k]) : 0);
    }
    return means;
  }

 private:
  Size size_;
  int columns_, rows_;
  std::vector<double> sums_;
  std::vector<std::size_t> counts_;
};

void count_raw(const Frame& frame, Appearance& appearance) {
  const FrameFormat& format = frame.format;
  if (!frame.is_whole()) {
    throw Error(fmt::format("frame {}: {} bytes are too few for {}; take it again", frame.sequence, frame.bytes.size(),
                            to_text(format)));
  }
  const bool bayer = is_bayer(format.pixels);
  std::vector<std::uint16_t> codes(static_cast<std::size_t>(format.size.width));
  Tiles tiles(format.size);
  for (int y = 0; y < format.size.height; ++y) {
    internal::unpack_row(format.pixels, frame.bytes.data() + y * format.stride_bytes, format.size.width, codes.data());
    for (int x = 0; x < format.size.width; ++x) {
      const std::uint16_t code = codes[static_cast<std::size_t>(x)];
      const int colour = bayer ? cfa_channel(format.cfa, x, y) : 0;
      auto& counts = appearance.colours[static_cast<std::size_t>(colour)].counts;
      ++counts[std::min<std::size_t>(code, counts.size() - 1)];
      if (!bayer || colour == 1) tiles.add(x, y, code);
    }
  }
  appearance.tiles = tiles.means();
}

template <class Code>
void count_rgb(const Image<Code>& codes, Appearance& appearance) {
  Tiles tiles(codes.size());
  for (int y = 0; y < codes.height(); ++y) {
    const Code* pixel = codes.row(y);
    for (int x = 0; x < codes.width(); ++x, pixel += 3) {
      for (std::size_t c = 0; c < 3; ++c) ++appearance.colours[c].counts[pixel[c]];
      tiles.add(x, y, pixel[1]);
    }
  }
  appearance.tiles = tiles.means();
}

bool is_grey(PixelFormat pixels) {
  return pixels == PixelFormat::kGrey8 || pixels == PixelFormat::kGrey10 || pixels == PixelFormat::kGrey12 ||
         pixels == PixelFormat::kGrey16;
}

}  // namespace

UsableCodes usable_codes(const FrameFormat& format) {
  UsableCodes usable;
  const bool raw = is_bayer(format.pixels) || is_grey(format.pixels);
  // What develop() makes of the other formats has the full range.
  usable.black = raw ? format.black_level : 0;
  usable.white = raw ? format.white_level : std::ldexp(1.0, bits_of(format.pixels)) - 1;
  usable.linear = is_linear(format);
  const double range = usable.white - usable.black;
  usable.floor = usable.black + (bits_of(format.pixels) > 8 ? std::max(8.0, range / 512) : range * 16 / 255);
  usable.ceiling = usable.black + 0.98 * range;
  return usable;
}

double CodeHistogram::share_below(double code) const {
  const auto end = static_cast<std::size_t>(std::clamp(std::ceil(code), 0.0, static_cast<double>(counts.size())));
  const auto last = counts.begin() + static_cast<std::ptrdiff_t>(end);
  return total
             ? static_cast<double>(std::accumulate(counts.begin(), last, std::uint64_t{0})) / static_cast<double>(total)
             : 0;
}

double CodeHistogram::share_above(double code) const {
  return 1 - share_below(std::floor(code) + 1);
}

double CodeHistogram::quantile(double q) const {
  const double wanted = q * static_cast<double>(total);
  double below = 0;
  for (std::size_t code = 0; code < counts.size(); ++code) {
    const double here = counts[code];
    if (here > 0 && below + here >= wanted) return static_cast<double>(code) - 0.5 + (wanted - below) / here;
    below += here;
  }
  return static_cast<double>(counts.size()) - 0.5;
}

double Appearance::clipped() const {
  double share = 0;
  for (const CodeHistogram& colour : colours)
    share += colour.share_above(usable.ceiling) * static_cast<double>(colour.total);
  double total = 0;
  for (const CodeHistogram& colour : colours) total += static_cast<double>(colour.total);
  return total > 0 ? share / total : 0;
}

double Appearance::dark() const {
  double share = 0, total = 0;
  for (const CodeHistogram& colour : colours) {
    share += colour.share_below(usable.floor) * static_cast<double>(colour.total);
    total += static_cast<double>(colour.total);
  }
  return total > 0 ? share / total : 0;
}

Appearance appearance_of(const Frame& frame) {
  Appearance appearance;
  appearance.usable = usable_codes(frame.format);
  const bool grey = is_grey(frame.format.pixels);
  appearance.colours.resize(grey ? 1 : 3);
  for (CodeHistogram& colour : appearance.colours) {
    colour.counts.resize(static_cast<std::size_t>(appearance.usable.white) + 1);
  }
  if (grey || is_bayer(frame.format.pixels)) {
    count_raw(frame, appearance);
  } else {
    const Photo photo = develop(frame);
    HDR_ASSERT(static_cast<double>(photo.max_code()) == appearance.usable.white);
    std::visit([&](const auto& codes) { count_rgb(codes, appearance); }, photo.codes);
  }
  for (CodeHistogram& colour : appearance.colours) {
    colour.total = std::accumulate(colour.counts.begin(), colour.counts.end(), std::uint64_t{0});
  }
  return appearance;
}

bool agree(const Appearance& a, const Appearance& b) {
  if (a.tiles.size() != b.tiles.size()) return false;
  const double least = (a.usable.white - a.usable.black) / 255;
  std::size_t apart = 0;
  for (std::size_t k = 0; k < a.tiles.size(); ++k) {
    const double level = std::max(a.tiles[k], b.tiles[k]) - a.usable.black;
    if (std::abs(a.tiles[k] - b.tiles[k]) > std::max(least, 0.05 * level)) ++apart;
  }
  return 10 * apart <= a.tiles.size();
}

}  // namespace hdr
