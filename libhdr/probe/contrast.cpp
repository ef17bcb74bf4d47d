#include "libhdr/probe/internal/contrast.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/probe/internal/brightest.h"

namespace hdr::internal {
namespace {

constexpr int kBlock = 4;
constexpr int kRowsPerTask = 16;         ///< of blocks
constexpr int kOctaves = 3;              ///< eight times
constexpr float kDarkest = 1e-3f;        ///< of the brightest: what is darker counts as this
constexpr int kStepsPerOctave = 4;       ///< of the stored logarithms
constexpr float kLowestOctave = -31.75;  ///< code 1; code 0 is black
constexpr int kMostSteps = kOctaves * kStepsPerOctave;
constexpr int kStepsToDarkest = 39;  ///< -log2(kDarkest) kStepsPerOctave
constexpr std::uint8_t kUnseen = 255;

std::uint8_t code_of(float log2_value) {
  return static_cast<std::uint8_t>(std::clamp((log2_value - kLowestOctave) * kStepsPerOctave + 1.5f, 1.0f, 254.0f));
}

/// log2 within 0.01: the exponent, and the mantissa by a parabola.
float fast_log2(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const float m = std::bit_cast<float>((bits & 0x7fffffu) | 0x3f800000u) - 1;
  return static_cast<float>(static_cast<int>(bits >> 23) - 127) + m * (1.3465f - 0.3465f * m);
}

/// One row of blocks, column by column of pixels: the largest value, the product of all (four of them fit a float when
/// each is held within 1e-9 .. 1e9), and how many the source shows.
struct Columns {
  std::vector<float> value, most, product;
  std::vector<std::uint8_t> shown;

  explicit Columns(int width)
      : value(static_cast<std::size_t>(width)), most(value), product(value), shown(value.size()) {}

  void clear() {
    std::fill(most.begin(), most.end(), 0.0f);
    std::fill(product.begin(), product.end(), 1.0f);
    std::fill(shown.begin(), shown.end(), std::uint8_t{0});
  }

  /// The pixels of one row within the span; the least of their samples.
  float add(View<const float> pixels, int y, Neighbourhood::Span span) {
    const auto first = static_cast<std::size_t>(span.first), last = static_cast<std::size_t>(span.last);
    const float least = brightest_channels(pixels.pixel(span.first, y), pixels.channels(), span.last - span.first,
                                           value.data() + span.first);
    for (std::size_t x = first; x < last; ++x) most[x] = std::max(most[x], value[x]);
    for (std::size_t x = first; x < last; ++x) product[x] *= std::min(std::max(value[x], 1e-9f), 1e9f);
    for (std::size_t x = first; x < last; ++x) ++shown[x];
    return least;
  }

  /// Codes of the largest value and of the mean logarithm of the block of these columns.
  void codes(std::size_t first, std::size_t last, std::uint8_t& most_code, std::uint8_t& mean_code) const {
    float largest = 0, logs = 0;
    int count = 0;
    for (std::size_t x = first; x < last; ++x) {
      largest = std::max(largest, most[x]);
      logs += fast_log2(product[x]);
      count += shown[x];
    }
    most_code = mean_code = count > 0 ? 0 : kUnseen;
    if (count == 0) most_code = 0;
    if (!(largest > 0)) return;
    most_code = code_of(fast_log2(largest));
    mean_code = std::max(code_of(logs / static_cast<float>(count)),
                         static_cast<std::uint8_t>(std::max(0, most_code - kStepsToDarkest)));
  }
};

}  // namespace

/// Of each block, the codes of its largest value and of the mean of its logarithms, kUnseen where it shows nothing.
struct Contrast::Codes {
  int columns, rows;
  std::vector<std::uint8_t> most, mean;

  Codes(int columns_, int rows_)
      : columns(columns_),
        rows(rows_),
        most(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)),
        mean(most.size()) {}
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x);
  }

  /// Whether the brightest of the three by three blocks around exceeds the mean of their logarithms by too much.
  bool harsh(int bx, int by) const {
    int brightest = 0, count = 0, sum = 0;
    const auto each = [&](auto body) {
      for (int y = std::max(0, by - 1); y <= std::min(rows - 1, by + 1); ++y) {
        for (int x = std::max(0, bx - 1); x <= std::min(columns - 1, bx + 1); ++x) body(at(x, y));
      }
    };
    each([&](std::size_t k) { brightest = std::max<int>(brightest, most[k]); });
    each([&](std::size_t k) {
      if (mean[k] == kUnseen) return;
      sum += std::max<int>(mean[k], brightest - kStepsToDarkest);
      ++count;
    });
    return brightest > 0 && brightest * count - sum > kMostSteps * count;
  }
};

Contrast::Contrast(const Neighbourhood& source)
    : columns_((source.pixels().width() + kBlock - 1) / kBlock),
      rows_((source.pixels().height() + kBlock - 1) / kBlock),
      harsh_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
  Codes codes(columns_, rows_);
  measure(source, codes);
  judge(codes);
}

void Contrast::measure(const Neighbourhood& source, Codes& codes) {
  const View<const float> pixels = source.pixels();
  nonnegative_ = reduce_rows(
                     rows_, kRowsPerTask, 1,
                     [&](int first, int last) {
                       Columns columns(pixels.width());
                       float least = 0;
                       for (int by = first; by < last; ++by) {
                         columns.clear();
                         for (int y = by * kBlock; y < std::min(pixels.height(), (by + 1) * kBlock); ++y) {
                           for (int region = 0; region < source.regions(); ++region) {
                             const Neighbourhood::Span span = source.plain_in_row(region, y);
                             if (span.first < span.last) least = std::min(least, columns.add(pixels, y, span));
                           }
                         }
                         for (int bx = 0; bx < columns_; ++bx) {
                           const int right = std::min(pixels.width(), (bx + 1) * kBlock);
                           columns.codes(static_cast<std::size_t>(bx * kBlock), static_cast<std::size_t>(right),
                                         codes.most[codes.at(bx, by)], codes.mean[codes.at(bx, by)]);
                         }
                       }
                       return least >= 0 ? 1 : 0;
                     },
                     [](int& total, int part) { total &= part; }) == 1;
}

/// Most blocks are not harsh because the brightest around is not so much above the darkest: extremes of three by three,
/// down and then across.
void Contrast::judge(const Codes& codes) {
  const auto width = static_cast<std::size_t>(columns_);
  any_ = reduce_rows(
             rows_, kRowsPerTask, 0,
             [&](int first, int last) {
               std::vector<std::uint8_t> most(width + 2, 0), least(width + 2, kUnseen);
               bool any = false;
               for (int by = first; by < last; ++by) {
                 std::fill(most.begin(), most.end(), std::uint8_t{0});
                 std::fill(least.begin(), least.end(), kUnseen);
                 for (int y = std::max(0, by - 1); y <= std::min(rows_ - 1, by + 1); ++y) {
                   const std::uint8_t *a = codes.most.data() + codes.at(0, y), *b = codes.mean.data() + codes.at(0, y);
                   for (std::size_t x = 0; x < width; ++x) most[x + 1] = std::max(most[x + 1], a[x]);
                   for (std::size_t x = 0; x < width; ++x) least[x + 1] = std::min(least[x + 1], b[x]);
                 }
                 for (std::size_t x = 0; x < width; ++x) {
                   const int brightest = std::max({most[x], most[x + 1], most[x + 2]});
                   const int darkest = std::min({least[x], least[x + 1], least[x + 2]});
                   if (brightest - darkest <= kMostSteps) continue;
                   const bool harsh = codes.harsh(static_cast<int>(x), by);
                   harsh_[codes.at(static_cast<int>(x), by)] = harsh;
                   any |= harsh;
                 }
               }
               return any ? 1 : 0;
             },
             [](int& total, int part) { total |= part; }) == 1;
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
