#include "tools/hdr/map_digest.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "tools/hdr/report/picture.h"

namespace hdr::tools {
namespace {

/// The cell of `to` that place k of `from` falls into: those of report::reduced().
int cell(int k, int from, int to) {
  return static_cast<int>(((static_cast<std::int64_t>(k) + 1) * to - 1) / from);
}

constexpr double kLeastDoubt = -16;  ///< log2

}  // namespace

MapDigest::MapDigest(Size size)
    : size_(size),
      small_(report::reduced_size(size, kPixels)),
      picture_(small_, 3),
      clipped_(small_, 1),
      dark_(small_, 1),
      sums_(static_cast<std::size_t>(small_.width) * 4),
      luminances_(kBins),
      doubts_(kHighest - kLowest) {
  for (int x = 0; x < size.width; ++x) column_.push_back(cell(x, size.width, small_.width));
}

void MapDigest::put(const MapRows& rows) {
  for (int k = 0; k < rows.rgb.height(); ++k) {
    const int y = rows.first + k, row = cell(y, size_.height, small_.height);
    if (row != row_) finish_row(row_);
    row_ = row;
    add_row(rows, k);
    if (y + 1 == size_.height) finish_row(row_);
  }
}

void MapDigest::add_row(const MapRows& rows, int k) {
  for (int x = 0; x < size_.width; ++x) {
    const auto column = static_cast<std::size_t>(column_[static_cast<std::size_t>(x)]);
    const float* p = rows.rgb.pixel(x, k);
    for (std::size_t c = 0; c < 3; ++c) sums_[4 * column + c] += p[c];
    sums_[4 * column + 3] += 1;
    ++pixels_;
    if (!rows.flags.empty()) {
      const std::uint8_t flags = rows.flags(x, k);
      if (flags & kClippedFlag) clipped_(static_cast<int>(column), row_) = 255;
      if (flags & kDarkFlag) dark_(static_cast<int>(column), row_) = 255;
    }
    const double value = luminance<double>(p[0], p[1], p[2]);
    if (!(value > 0) || !std::isfinite(value)) continue;
    const double stop = std::clamp<double>(std::log2(value), kLowest, kHighest - 1e-6) - kLowest;
    ++luminances_[static_cast<std::size_t>(stop * kBinsAStop)];
    if (rows.stddev.empty()) continue;
    const float* s = rows.stddev.pixel(x, k);
    // Channels err independently.
    const double deviation = std::hypot(0.2126 * s[0], 0.7152 * s[1], 0.0722 * s[2]) / value;
    const double octave = std::log2(std::max(deviation, 1e-9)) - kLeastDoubt;
    ++doubts_[static_cast<std::size_t>(stop)][static_cast<std::size_t>(std::clamp(8 * octave, 0.0, kDoubtBins - 1.0))];
  }
}

void MapDigest::finish_row(int row) {
  for (int x = 0; x < small_.width; ++x) {
    double* sum = &sums_[4 * static_cast<std::size_t>(x)];
    for (int c = 0; c < 3; ++c) picture_(x, row, c) = static_cast<float>(sum[c] / std::max(1.0, sum[3]));
  }
  std::fill(sums_.begin(), sums_.end(), 0.0);
}

double MapDigest::quantile(double share) const {
  std::int64_t all = 0, below = 0;
  for (const std::int64_t count : luminances_) all += count;
  for (std::size_t k = 0; k < luminances_.size(); ++k) {
    below += luminances_[k];
    if (below > 0 && static_cast<double>(below) >= share * static_cast<double>(all)) {
      return kLowest + (static_cast<double>(k) + 0.5) / kBinsAStop;
    }
  }
  return std::nan("");
}

double MapDigest::quantile_of(const DoubtCounts& counts, double share) {
  std::int64_t all = 0, below = 0;
  for (const std::int64_t count : counts) all += count;
  if (all == 0) return std::nan("");
  for (std::size_t k = 0; k < counts.size(); ++k) {
    below += counts[k];
    if (static_cast<double>(below) >= share * static_cast<double>(all)) {
      return std::exp2(kLeastDoubt + (static_cast<double>(k) + 0.5) / 8);
    }
  }
  return std::nan("");
}

double MapDigest::doubt(int stop, double share) const {
  return quantile_of(doubts_.at(static_cast<std::size_t>(stop - kLowest)), share);
}

double MapDigest::doubt(double share) const {
  DoubtCounts all{};
  for (const DoubtCounts& counts : doubts_) {
    for (std::size_t k = 0; k < all.size(); ++k) all[k] += counts[k];
  }
  return quantile_of(all, share);
}

void DigestingSink::put(const MapRows& rows) {
  if (digest_) digest_->put(rows);
  MapRows kept = rows;
  if (!layers_) {
    kept.stddev = {};
    kept.flags = {};
  }
  to_.put(kept);
}

}  // namespace hdr::tools
