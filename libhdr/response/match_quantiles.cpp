// [Grossberg03] What can be Known about the Radiometric Response from Images? The response keeps the order of
// radiances, so the histograms of two shots determine the map from codes to codes between them without registration.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "libhdr/core/parallel.h"
#include "libhdr/core/photo_samples.h"
#include "libhdr/response/internal/observations.h"

namespace hdr {
namespace {

constexpr int kBins = 1024;  ///< of codes deeper than that

using Counts = std::vector<std::int64_t>;

int bins_of(const Photo& photo) {
  return std::min(photo.max_code() + 1, kBins);
}

/// How many pixels of a regular lattice have a code in each bin, channel after channel.
Counts counted_codes(const Photo& photo) {
  const auto bins = static_cast<std::size_t>(bins_of(photo));
  const int shift = std::max(0, photo.bits - 10);
  Counts counts(3 * bins);
  const auto count = [&](const auto& lattice) {
    for (int y = 0; y < lattice.height(); ++y) {
      const auto* p = lattice.row(y);
      for (int x = 0; x < lattice.width(); ++x, p += 3) {
        ++counts[static_cast<std::size_t>(p[0] >> shift)];
        ++counts[bins + static_cast<std::size_t>(p[1] >> shift)];
        ++counts[2 * bins + static_cast<std::size_t>(p[2] >> shift)];
      }
    }
  };
  std::visit(count, samples_of(photo)->lattice);
  return counts;
}

/// Share of a shot's pixels below each code. Code bin b covers [b - 1/2, b + 1/2] `bin_width` codes.
class Distribution {
 public:
  /// `counts`: of the bins of one channel.
  Distribution(const Photo& photo, std::span<const std::int64_t> counts)
      : bin_width_(static_cast<double>(photo.max_code() + 1) / static_cast<double>(counts.size())) {
    below_.push_back(0);
    for (const std::int64_t count : counts) below_.push_back(below_.back() + static_cast<double>(count));
    for (double& value : below_) value /= std::max(1.0, below_.back());
    if (bin_width_ > 1) offset_ = 0.5 * bin_width_ - 0.5;  // the middle of a bin of several codes
  }

  /// The rank at the middle of a bin.
  double rank(int bin) const {
    return 0.5 * (below_[static_cast<std::size_t>(bin)] + below_[static_cast<std::size_t>(bin) + 1]);
  }
  double share(int bin) const {
    return below_[static_cast<std::size_t>(bin) + 1] - below_[static_cast<std::size_t>(bin)];
  }
  int bins() const { return static_cast<int>(below_.size()) - 1; }
  double code(int bin) const { return bin * bin_width_ + offset_; }

  /// The code below which a share `rank` of the pixels lies, its pixels spread evenly over its cell.
  double quantile(double rank) const {
    const auto above = std::upper_bound(below_.begin(), below_.end(), rank);
    const auto bin = std::clamp(static_cast<int>(above - below_.begin()) - 1, 0, bins() - 1);
    if (share(bin) <= 0) return code(bin);
    const double inside = (rank - below_[static_cast<std::size_t>(bin)]) / share(bin);
    return (bin + inside - 0.5) * bin_width_ + offset_;
  }

 private:
  double bin_width_ = 1, offset_ = 0;
  std::vector<double> below_;
};

Eigen::MatrixXd matched_codes(const Bracket& bracket, const std::vector<Distribution>& distributions) {
  const auto shots = static_cast<Eigen::Index>(bracket.shots.size());
  // A rank for each second usable code of each shot: they are spread over the codes of the whole bracket.
  std::vector<double> ranks;
  for (Eigen::Index j = 0; j < shots; ++j) {
    const Distribution& d = distributions[static_cast<std::size_t>(j)];
    const UsableCodes usable = usable_codes(bracket.bits(), true);
    for (int bin = 0; bin < d.bins(); bin += std::max(2, d.bins() / 128)) {
      if (usable.contains(d.code(bin)) && d.share(bin) > 0) ranks.push_back(d.rank(bin));
    }
  }
  Eigen::MatrixXd codes = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(ranks.size()), shots, NAN);
  for (Eigen::Index i = 0; i < codes.rows(); ++i) {
    for (Eigen::Index j = 0; j < shots; ++j) {
      const double code = distributions[static_cast<std::size_t>(j)].quantile(ranks[static_cast<std::size_t>(i)]);
      if (usable_codes(bracket.bits(), true).contains(code)) codes(i, j) = code;
    }
  }
  return codes;
}

}  // namespace

Observations match_quantiles(const Bracket& bracket) {
  Observations observations;
  observations.bits = bracket.bits();
  observations.ln_exposure.resize(static_cast<Eigen::Index>(bracket.shots.size()));
  for (std::size_t j = 0; j < bracket.shots.size(); ++j) {
    observations.ln_exposure[static_cast<Eigen::Index>(j)] = std::log(bracket.shots[j].relative_exposure());
  }
  std::array<std::vector<Distribution>, 3> distributions;
  std::vector<Counts> counts(bracket.shots.size());
  for_rows(static_cast<int>(counts.size()), 1, [&](int first, int) {
    const auto j = static_cast<std::size_t>(first);
    counts[j] = counted_codes(bracket.shots[j]);
  });
  for (std::size_t j = 0; j < counts.size(); ++j) {
    const auto bins = static_cast<std::size_t>(bins_of(bracket.shots[j]));
    for (std::size_t c = 0; c < 3; ++c) {
      distributions[c].emplace_back(bracket.shots[j], std::span(counts[j]).subspan(c * bins, bins));
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    observations.codes[c] = rows_seen_twice(matched_codes(bracket, distributions[c]), observations.ln_exposure);
  }
  return observations;
}

}  // namespace hdr
