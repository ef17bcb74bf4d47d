#include "libhdr/probe/internal/contrast.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "libhdr/core/parallel.h"

namespace hdr::internal {
namespace {

constexpr int kRowsPerBlock = 16;
constexpr double kOctaves = 3;            ///< eight times
constexpr double kDarkest = 1e-3;         ///< of the brightest: what is darker counts as this
constexpr int kStepsPerOctave = 4;        ///< of the stored logarithms
constexpr double kLowestOctave = -31.75;  ///< code 1; code 0 is black

std::uint8_t code_of(double log2_value) {
  return static_cast<std::uint8_t>(std::clamp((log2_value - kLowestOctave) * kStepsPerOctave + 1.5, 1.0, 255.0));
}

/// log2 within 0.01: the exponent, and the mantissa by a parabola.
float fast_log2(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const float m = std::bit_cast<float>((bits & 0x7fffffu) | 0x3f800000u) - 1;
  return static_cast<float>(static_cast<int>(bits >> 23) - 127) + m * (1.3465f - 0.3465f * m);
}

/// What a block holds: the codes of its largest value and of the mean of its logarithms.
struct Block {
  std::uint8_t most = 0, mean = 0;
  bool shown = false;
};

/// How much of a block the source shows.
enum class Shown { kNone, kPart, kAll };

Shown shown_of(const Neighbourhood& source, const PixelBox& block) {
  const int region = source.region_of({0.5 * (block.first_x + block.last_x), 0.5 * (block.first_y + block.last_y)});
  if (source.is_plain(region, block)) return Shown::kAll;
  for (const int x : {block.first_x, block.last_x - 1}) {
    for (const int y : {block.first_y, block.last_y - 1}) {
      if (source.is_plain(region, {x, y, x + 1, y + 1})) return Shown::kPart;
    }
  }
  return Shown::kNone;
}

struct RowsResult {
  bool nonnegative = true, any = false;
};

}  // namespace

Contrast::Contrast(const Neighbourhood& source)
    : columns_((source.pixels().width() + kBlock - 1) / kBlock),
      rows_((source.pixels().height() + kBlock - 1) / kBlock),
      harsh_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
  const View<const float> pixels = source.pixels();
  std::vector<Block> blocks(harsh_.size());
  const int channels = pixels.channels();
  const auto join = [](RowsResult& total, const RowsResult& part) {
    total.nonnegative &= part.nonnegative;
    total.any |= part.any;
  };
  const auto measure = [&](int first, int last) {
    RowsResult result;
    std::vector<float> row(static_cast<std::size_t>(pixels.width()));
    struct Sums {
      float most = 0, logs = 0;
      int count = 0;
      Shown shown = Shown::kAll;
    };
    std::vector<Sums> sums(static_cast<std::size_t>(columns_));
    for (int by = first; by < last; ++by) {
      const int end = std::min(pixels.height(), (by + 1) * kBlock);
      for (int bx = 0; bx < columns_; ++bx) {
        const int right = std::min(pixels.width(), (bx + 1) * kBlock);
        sums[static_cast<std::size_t>(bx)] = {0, 0, 0, shown_of(source, {bx * kBlock, by * kBlock, right, end})};
      }
      for (int y = by * kBlock; y < end; ++y) {
        const float* p = pixels.row(y);
        float least = 0;
        for (std::size_t x = 0; x < row.size(); ++x, p += channels) {
          float value = p[0];
          least = std::min(least, p[0]);
          for (int c = 1; c < channels; ++c) {
            value = std::max(value, p[c]);
            least = std::min(least, p[c]);
          }
          row[x] = value;
        }
        result.nonnegative &= least >= 0;
        for (std::size_t x = 0; x < row.size(); ++x) {
          Sums& block = sums[x / kBlock];
          if (block.shown != Shown::kAll) {
            const int i = static_cast<int>(x);
            if (block.shown == Shown::kNone) continue;
            if (!source.is_plain(source.region_of({i + 0.5, y + 0.5}), {i, y, i + 1, y + 1})) continue;
          }
          block.most = std::max(block.most, row[x]);
          block.logs += fast_log2(std::max(row[x], 1e-9f));
          ++block.count;
        }
      }
      for (int bx = 0; bx < columns_; ++bx) {
        const Sums& block = sums[static_cast<std::size_t>(bx)];
        Block& own =
            blocks[static_cast<std::size_t>(by) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(bx)];
        own.shown = block.count > 0;
        if (!(block.most > 0)) continue;
        const auto most = static_cast<double>(block.most);
        const double mean = std::max(static_cast<double>(block.logs) / block.count, std::log2(most * kDarkest));
        own.most = code_of(std::log2(most));
        own.mean = code_of(mean);
      }
    }
    return result;
  };
  nonnegative_ = reduce_rows(rows_, kRowsPerBlock, RowsResult{}, measure, join).nonnegative;

  const auto judge = [&](int first, int last) {
    RowsResult result;
    for (int by = first; by < last; ++by) {
      for (int bx = 0; bx < columns_; ++bx) {
        int most = 0, count = 0, sum = 0;
        for (int j = std::max(0, by - 1); j <= std::min(rows_ - 1, by + 1); ++j) {
          for (int i = std::max(0, bx - 1); i <= std::min(columns_ - 1, bx + 1); ++i) {
            most = std::max<int>(
                most,
                blocks[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i)]
                    .most);
          }
        }
        const int darkest = most - static_cast<int>(-std::log2(kDarkest) * kStepsPerOctave);
        for (int j = std::max(0, by - 1); j <= std::min(rows_ - 1, by + 1); ++j) {
          for (int i = std::max(0, bx - 1); i <= std::min(columns_ - 1, bx + 1); ++i) {
            const Block& b =
                blocks[static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i)];
            if (!b.shown) continue;
            sum += std::max<int>(b.mean, darkest);
            ++count;
          }
        }
        const bool is_harsh = most > 0 && most * count - sum > kOctaves * kStepsPerOctave * count;
        harsh_[static_cast<std::size_t>(by) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(bx)] =
            is_harsh;
        result.any |= is_harsh;
      }
    }
    return result;
  };
  any_ = reduce_rows(rows_, kRowsPerBlock, RowsResult{}, judge, join).any;
}

bool Contrast::harsh(int first_x, int first_y, int last_x, int last_y) const {
  if (!any_) return false;
  const int x0 = std::clamp(first_x / kBlock, 0, columns_ - 1), x1 = std::clamp(last_x / kBlock, 0, columns_ - 1);
  const int y0 = std::clamp(first_y / kBlock, 0, rows_ - 1), y1 = std::clamp(last_y / kBlock, 0, rows_ - 1);
  for (int y = y0; y <= y1; ++y) {
    const std::uint8_t* row = harsh_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_);
    for (int x = x0; x <= x1; ++x) {
      if (row[x]) return true;
    }
  }
  return false;
}

}  // namespace hdr::internal
