#include "libhdr/light/step_distribution.h"

#include <algorithm>
#include <bit>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

constexpr double kBelowOne = 1 - 0x1p-53;

}  // namespace

StepDistribution::StepDistribution(std::span<const double> weights)
    : sums_(weights.size() + 1, 0.0), guide_(std::bit_ceil(4 * weights.size()), 0) {
  HDR_ASSERT(!weights.empty());
  for (std::size_t k = 0; k < weights.size(); ++k) sums_[k + 1] = sums_[k] + weights[k];
  total_ = sums_.back();
  if (!(total_ > 0)) return;
  for (double& sum : sums_) sum /= total_;
  const double size = static_cast<double>(guide_.size());
  std::uint32_t step = 0;
  for (std::size_t k = 0; k < guide_.size(); ++k) {
    while (sums_[step + 1] <= static_cast<double>(k) / size) ++step;
    guide_[k] = step;
  }
}

StepDistribution::Step StepDistribution::step_of(double u) const {
  const std::size_t size = guide_.size();
  const auto k = std::min(static_cast<std::size_t>(u * static_cast<double>(size)), size - 1);
  // The first sum above u ends its step: steps of no weight are passed over. It lies between two entries of the guide.
  // There are four times as many entries as steps, so that it is mostly the first.
  auto above = sums_.begin() + guide_[k] + 1;
  if (*above <= u) {
    const auto last = k + 1 < size ? sums_.begin() + guide_[k + 1] + 1 : sums_.end() - 1;
    above = std::upper_bound(above, last, u);
  }
  const double low = *(above - 1), high = *above;
  const double inside = high > low ? std::clamp((u - low) / (high - low), 0.0, kBelowOne) : 0.5;
  return {static_cast<int>(above - sums_.begin()) - 1, inside};
}

double StepDistribution::invert(const Step& step) const {
  const auto k = static_cast<std::size_t>(step.index);
  return std::min(sums_[k] + step.inside * (sums_[k + 1] - sums_[k]), kBelowOne);
}

}  // namespace hdr
