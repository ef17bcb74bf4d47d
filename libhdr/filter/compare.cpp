#include "libhdr/filter/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hdr {
namespace {

using Samples = std::vector<double>;

// The middle value; of an even number, the mean of the two middle ones. Reorders the samples.
double median(Samples& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

// Nearest rank: the smallest sample that at least this share of all samples does not exceed. Reorders the samples.
double percentile(Samples& values, double share) {
  if (values.empty()) return 0;
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(values.size()))) - 1;
  const auto place = values.begin() + std::max<std::ptrdiff_t>(rank, 0);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// body(channel, a, b) for every unmasked sample.
template <class Body>
void for_samples(View<const float> a, View<const float> b, View<const std::uint8_t> mask, const Body& body) {
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      if (!mask.empty() && mask(x, y) == 0) continue;
      for (int c = 0; c < a.channels(); ++c) body(c, a(x, y, c), b(x, y, c));
    }
  }
}

std::array<double, 3> scale_of(View<const float> a, View<const float> b, View<const std::uint8_t> mask,
                               CompareScale scale) {
  if (scale == CompareScale::kNone) return {1, 1, 1};
  const bool shared = scale == CompareScale::kGlobal;
  std::array<Samples, 3> logs;
  for_samples(a, b, mask, [&](int c, double va, double vb) {
    if (!(va > 0 && vb > 0 && std::isfinite(va) && std::isfinite(vb))) return;
    logs[shared ? 0 : static_cast<std::size_t>(c)].push_back(std::log(vb) - std::log(va));
  });
  if (shared) {
    const double factor = std::exp(median(logs[0]));
    return {factor, factor, factor};
  }
  return {std::exp(median(logs[0])), std::exp(median(logs[1])), std::exp(median(logs[2]))};
}

void check_shapes(View<const float> a, View<const float> b, View<const std::uint8_t> mask) {
  HDR_ASSERT(a.channels() <= 3 && b.channels() <= 3);
  if (a.size() != b.size() || a.channels() != b.channels()) {
    throw Error(
        fmt::format("the pictures have different sizes, {}x{} with {} channels and {}x{} with {}; only pictures "
                    "of one size can be compared",
                    a.width(), a.height(), a.channels(), b.width(), b.height(), b.channels()));
  }
  if (!mask.empty() && mask.size() != a.size()) {
    throw Error(fmt::format("the mask is {}x{}, the pictures {}x{}; a mask must have their size", mask.width(),
                            mask.height(), a.width(), a.height()));
  }
}

}  // namespace

Comparison compare(View<const float> a, View<const float> b, CompareScale scale, View<const std::uint8_t> mask) {
  check_shapes(a, b, mask);
  Comparison result;
  result.scale = scale_of(a, b, mask, scale);
  double square_error = 0, square = 0;
  Samples stops;
  for_samples(a, b, mask, [&](int c, double va, double vb) {
    const bool finite_a = std::isfinite(va), finite_b = std::isfinite(vb);
    result.nonfinite[0] += !finite_a;
    result.nonfinite[1] += !finite_b;
    if (!finite_a || !finite_b) return;
    const double scaled = result.scale[static_cast<std::size_t>(c)] * va;
    square_error += (scaled - vb) * (scaled - vb);
    square += vb * vb;
    result.max_abs = std::max(result.max_abs, std::abs(scaled - vb));
    if (scaled > 0 && vb > 0) stops.push_back(std::abs(std::log2(scaled / vb)));
  });
  if (square > 0) {
    result.rel_rmse = std::sqrt(square_error / square);
  } else if (square_error > 0) {
    result.rel_rmse = std::numeric_limits<double>::infinity();
  }
  result.p99_abs_log2 = percentile(stops, 0.99);
  result.median_abs_log2 = median(stops);
  return result;
}

}  // namespace hdr
