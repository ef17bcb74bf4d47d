#pragma once
// What a report shows of a radiance map, gathered as its rows pass by: a small picture, how often each luminance
// occurs, where it is clipped or dark, and how sure it is.
#include <array>
#include <cstdint>
#include <vector>

#include "libhdr/core/rows.h"

namespace hdr::tools {

class MapDigest final : public MapSink {
 public:
  static constexpr int kPixels = 300000;  ///< of the small picture, at most
  static constexpr int kLowest = -60, kHighest = 60, kBinsAStop = 4;
  static constexpr int kBins = (kHighest - kLowest) * kBinsAStop;

  explicit MapDigest(Size size);
  void put(const MapRows& rows) override;

  Size size() const { return size_; }
  const Image<float>& picture() const { return picture_; }  ///< after the last row
  const Image<std::uint8_t>& clipped() const { return clipped_; }
  const Image<std::uint8_t>& dark() const { return dark_; }
  /// Pixels whose log2 luminance is in [kLowest + k / kBinsAStop, ...).
  const std::vector<std::int64_t>& luminances() const { return luminances_; }
  std::int64_t pixels() const { return pixels_; }
  /// log2 of the luminance below which a share of the positive pixels lies; to a bin.
  double quantile(double share) const;
  /// Quantile of the standard deviation of luminance over its value among pixels of bin `stop` (whole stops from
  /// kLowest); NaN without any, or when no deviation was asked for. To an eighth.
  double doubt(int stop, double share) const;
  double doubt(double share) const;  ///< of all pixels

 private:
  static constexpr int kDoubtBins = 8 * 20;  ///< log2 of the relative deviation from -16 to 4, eight an octave
  using DoubtCounts = std::array<std::int64_t, kDoubtBins>;
  static double quantile_of(const DoubtCounts& counts, double share);
  void add_row(const MapRows& rows, int k);
  void finish_row(int row);

  Size size_, small_;
  Image<float> picture_;
  Image<std::uint8_t> clipped_, dark_;
  std::vector<double> sums_;  ///< of one row of the picture
  std::vector<int> column_;   ///< the small picture's, of each pixel
  int row_ = 0;
  std::vector<std::int64_t> luminances_;
  std::vector<DoubtCounts> doubts_;  ///< for each whole stop
  std::int64_t pixels_ = 0;
};

/// Hands rows on to two sinks; the second gets neither deviations nor flags unless `layers`.
class DigestingSink final : public MapSink {
 public:
  DigestingSink(MapSink* digest, MapSink& to, bool layers) : digest_(digest), to_(to), layers_(layers) {}
  void put(const MapRows& rows) override;

 private:
  MapSink* digest_;  ///< may be none
  MapSink& to_;
  bool layers_;
};

}  // namespace hdr::tools
