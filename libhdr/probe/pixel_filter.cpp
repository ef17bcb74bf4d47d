#include "libhdr/probe/internal/pixel_filter.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/kernel.h"

namespace hdr::internal {
namespace {

/// On a lat-long a step of one column is shorter the nearer a row is to its pole: by how much more than in the kernel's
/// middle. Rows beyond the pole mirror those before it.
double widening(int row, double middle_y, int height) {
  const double here = std::abs(std::sin(kPi * middle_y / height)),
               there = std::abs(std::sin(kPi * (row + 0.5) / height));
  return here / std::max(there, 1e-9);
}

}  // namespace

PixelFilter::PixelFilter(const Neighbourhood& source, const SourcePicture& bilinear, const Contrast& contrast)
    : source_(source),
      bilinear_(bilinear),
      contrast_(contrast),
      sum_(static_cast<std::size_t>(source.pixels().channels())),
      value_(sum_.size()) {}

/// Adds `count` pixels of a row, a weight each; the sum of the weights. Three channels stay in registers.
template <PixelFilter::Of kOf>
double PixelFilter::add_pixels(const float* pixel, const double* weights, int count, double scale) {
  const auto term = [&](double weight, float value) {
    const double product = weight * static_cast<double>(value);
    return kOf == Of::kValues ? product : product * product;
  };
  double sum = 0;
  if (sum_.size() == 3) {
    double r = 0, g = 0, b = 0;
    for (int k = 0; k < count; ++k, pixel += 3) {
      const double weight = scale * weights[k];
      sum += weight;
      r += term(weight, pixel[0]);
      g += term(weight, pixel[1]);
      b += term(weight, pixel[2]);
    }
    sum_[0] += r;
    sum_[1] += g;
    sum_[2] += b;
    return sum;
  }
  for (int k = 0; k < count; ++k) {
    const double weight = scale * weights[k];
    sum += weight;
    for (double& channel : sum_) channel += term(weight, *pixel++);
  }
  return sum;
}

template <PixelFilter::Of kOf, class Kernel>
PixelFilter::Sums PixelFilter::add(int region, const Vec2& px, const KernelShape& shape) {
  const View<const float> pixels = source_.pixels();
  const double x = px.x() - 0.5, y = px.y() - 0.5;
  // Beyond the circle itself a row would be weighed again.
  const double most_across = source_.is_latlong() ? pixels.width() / (2.0 * Kernel::kReach) : 1e9;
  std::fill(sum_.begin(), sum_.end(), 0.0);
  Sums sums;
  const double half_height = Kernel::kReach * shape.down;
  for (int j = ceil_of(y - half_height); j <= y + half_height; ++j) {
    const double row_weight = Kernel::at((j - y) / shape.down);
    if (row_weight == 0) continue;
    const double wider = source_.is_latlong() ? widening(j, px.y(), pixels.height()) : 1;
    const double across = std::min(std::max(1.0, shape.across * wider), most_across);
    const double middle = x + shape.shear * wider * (j - y), half = Kernel::kReach * across;
    const int first = ceil_of(middle - half), last = floor_of(middle + half);
    const Neighbourhood::Span plain = source_.plain_in_row(region, j);
    const int begin = std::clamp(plain.first, first, last + 1), end = std::clamp(plain.last, begin, last + 1);
    weights_.resize(static_cast<std::size_t>(std::max(0, last - first + 1)));
    const double narrower = 1 / across;
    const auto weigh = [&](int from, int to) {
      for (int i = from; i < to; ++i)
        weights_[static_cast<std::size_t>(i - first)] = Kernel::at((i - middle) * narrower);
    };
    // Each row counts as its weight says, however many of its pixels the kernel meets.
    double in_row = 0;
    if constexpr (std::is_same_v<Kernel, TentKernel>) {
      source_.ends_at_rim() ? weigh(begin, end) : weigh(first, last + 1);
      in_row = TentKernel::sum(first, last, middle, narrower);
    } else {
      weigh(first, last + 1);
      for (const double weight : weights_) in_row += weight;
    }
    if (std::abs(in_row) < 1e-6) continue;
    const double scale = row_weight / in_row;
    sums.whole_weight += row_weight;
    if (begin < end) {
      sums.weight += add_pixels<kOf>(pixels.pixel(begin, j), weights_.data() + (begin - first), end - begin, scale);
    }
    if (source_.ends_at_rim()) {
      sums.missing = sums.missing || begin > first || end <= last;
      continue;
    }
    const auto add_taps = [&](int from, int to) {
      for (int i = from; i < to; ++i) {
        const double* weight = &weights_[static_cast<std::size_t>(i - first)];
        if (*weight == 0) continue;
        if (!source_.tap(region, i, j, value_.data())) {
          sums.missing = true;
        } else {
          sums.weight += add_pixels<kOf>(value_.data(), weight, 1, scale);
        }
      }
    };
    add_taps(first, begin);
    add_taps(end, last + 1);
  }
  return sums;
}

PixelBox PixelFilter::seen(const Vec2& px, const KernelShape& shape) const {
  const double rx = std::min(reach_x(shape, SharpKernel::kReach), 0.5 * source_.pixels().width());
  const double ry = reach_y(shape, SharpKernel::kReach);
  return {static_cast<int>(px.x() - rx), static_cast<int>(px.y() - ry), static_cast<int>(px.x() + rx) + 1,
          static_cast<int>(px.y() + ry) + 1};
}

bool PixelFilter::is_harsh(const PixelBox& box) const {
  if (contrast_.harsh(box.first_x, box.first_y, box.last_x - 1, box.last_y - 1)) return true;
  if (!source_.is_latlong()) return false;
  const int width = source_.pixels().width();
  return (box.first_x < 0 && contrast_.harsh(box.first_x + width, box.first_y, width, box.last_y - 1)) ||
         (box.last_x > width && contrast_.harsh(0, box.first_y, box.last_x - 1 - width, box.last_y - 1));
}

template <PixelFilter::Of kOf>
PixelFilter::Sums PixelFilter::add_chosen(int region, const Vec2& px, const KernelShape& shape, double scale) {
  constexpr double kLeastShown = 0.25;
  Sums sums;
  const PixelBox box = seen(px, shape);
  // Around a circle of fewer pixels a kernel with lobes would have to be squeezed until it meets lobes alone.
  const bool narrow = source_.is_latlong() && source_.pixels().width() < 2 * InterpolatingKernel::kReach;
  bool sharp = !narrow && !is_harsh(box) && !(source_.ends_at_rim() && !source_.is_plain(region, box));
  if (sharp) {
    sums = scale <= kHarmlessScale ? add<kOf, InterpolatingKernel>(region, px, {})
                                   : add<kOf, SharpKernel>(region, px, shape);
    sharp = !sums.missing;  // at a rim what is left of a kernel with negative lobes is no mean
  }
  if (!sharp) sums = add<kOf, TentKernel>(region, px, shape);
  if (!(sums.weight > kLeastShown * sums.whole_weight) || !(sums.weight > 0)) {
    std::fill(sum_.begin(), sum_.end(), 0.0);
    bilinear_.add(px, sum_.data());
    sums.weight = 1;
    if (kOf == Of::kDeviations) {
      for (double& sum : sum_) sum *= sum;
    }
  }
  return sums;
}

void PixelFilter::write(int region, const Vec2& px, const KernelShape& shape, double scale, float* mean) {
  const Sums sums = add_chosen<Of::kValues>(region, px, shape, scale);
  const bool keep_positive = contrast_.nonnegative();
  for (std::size_t c = 0; c < sum_.size(); ++c) {
    const double value = sum_[c] / sums.weight;
    mean[c] = static_cast<float>(keep_positive ? std::max(0.0, value) : value);
  }
}

void PixelFilter::write_root(const Sums& sums, float* deviation) const {
  for (std::size_t c = 0; c < sum_.size(); ++c) deviation[c] = static_cast<float>(std::sqrt(sum_[c]) / sums.weight);
}

void PixelFilter::write_deviation(int region, const Vec2& px, const KernelShape& shape, double scale,
                                  float* deviation) {
  write_root(add_chosen<Of::kDeviations>(region, px, shape, scale), deviation);
}

void PixelFilter::write_deviation(KernelKind kind, int region, const Vec2& px, const KernelShape& shape,
                                  float* deviation) {
  constexpr Of kOf = Of::kDeviations;
  const Sums sums = kind == KernelKind::kSharp    ? add<kOf, SharpKernel>(region, px, shape)
                    : kind == KernelKind::kTent   ? add<kOf, TentKernel>(region, px, shape)
                    : kind == KernelKind::kSpline ? add<kOf, CardinalSplineKernel>(region, px, {})
                                                  : add<kOf, InterpolatingKernel>(region, px, {});
  write_root(sums, deviation);
}

}  // namespace hdr::internal
