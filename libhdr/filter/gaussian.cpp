#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/core/internal/opencv.h"
#include "libhdr/core/parallel.h"
#include "libhdr/filter/blur.h"
#include "libhdr/filter/internal/sphere_gaussian.h"

namespace hdr {
namespace {

constexpr double kCut = 6;  ///< sigmas: what lies beyond is 1.5e-8 of the peak

/// The weights of one output sample: those of inputs first, first + 1, ... (beyond the borders: mirrored).
struct Taps {
  int first = 0;
  std::vector<float> weights;
};

/// Gaussian resampling of an axis from `from` to `to` samples; `sigma` in samples of the input. Weights add up to 1.
std::vector<Taps> gaussian_taps(int from, int to, double sigma) {
  std::vector<Taps> all(static_cast<std::size_t>(to));
  const double step = 1.0 * from / to;
  for (int k = 0; k < to; ++k) {
    const double centre = (k + 0.5) * step - 0.5;
    Taps& taps = all[static_cast<std::size_t>(k)];
    taps.first = static_cast<int>(std::ceil(centre - kCut * sigma));
    const int last = static_cast<int>(std::floor(centre + kCut * sigma));
    std::vector<double> exact;
    double sum = 0;
    for (int i = taps.first; i <= last; ++i) {
      exact.push_back(std::exp(-0.5 * std::pow((i - centre) / sigma, 2)));
      sum += exact.back();
    }
    if (!(sum > 0)) {  // narrower than the distance to the nearest sample
      taps.first = static_cast<int>(std::lround(centre));
      exact = {1};
      sum = 1;
    }
    for (const double weight : exact) taps.weights.push_back(static_cast<float>(weight / sum));
  }
  return all;
}

/// ... 1 0 | 0 1 2 ... n-1 | n-1 n-2 ...
int mirrored(int i, int n) {
  const int period = 2 * n;
  const int k = ((i % period) + period) % period;
  return k < n ? k : period - 1 - k;
}

/// Down the columns. Some dozens of positive float products: their sum is good to 1e-6.
Image<float> filter_columns(View<const float> in, const std::vector<Taps>& all) {
  constexpr std::ptrdiff_t kStrip = 512;  // floats: the rows of a window stay in the cache
  Image<float> out(in.width(), static_cast<int>(all.size()), in.channels());
  const auto samples = static_cast<std::ptrdiff_t>(out.row_samples());
  for_rows(out.height(), 16, [&](int first, int last) {
    for (std::ptrdiff_t left = 0; left < samples; left += kStrip) {
      const std::ptrdiff_t count = std::min(kStrip, samples - left);
      for (int y = first; y < last; ++y) {
        const Taps& taps = all[static_cast<std::size_t>(y)];
        float sums[kStrip] = {};
        for (std::size_t t = 0; t < taps.weights.size(); ++t) {
          const float* row = in.row(mirrored(taps.first + static_cast<int>(t), in.height())) + left;
          const float weight = taps.weights[t];
          for (std::ptrdiff_t k = 0; k < count; ++k) sums[k] += weight * row[k];
        }
        std::copy_n(sums, count, out.row(y) + left);
      }
    }
  });
  return out;
}

/// Along the rows.
Image<float> filter_rows(View<const float> in, const std::vector<Taps>& all) {
  const int channels = in.channels();
  Image<float> out(static_cast<int>(all.size()), in.height(), channels);
  for_rows(out.height(), 8, [&](int first, int last) {
    const int before = -all.front().first;
    const int after = all.back().first + static_cast<int>(all.back().weights.size()) - in.width();
    const int left = std::max(0, before), padded_width = left + in.width() + std::max(0, after);
    std::vector<float> padded(static_cast<std::size_t>(padded_width) * static_cast<std::size_t>(channels));
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < padded_width; ++x) {
        std::copy_n(in.pixel(mirrored(x - left, in.width()), y), channels,
                    &padded[static_cast<std::size_t>(x * channels)]);
      }
      float* row = out.row(y);
      for (int x = 0; x < out.width(); ++x) {
        const Taps& taps = all[static_cast<std::size_t>(x)];
        const float* from = padded.data() + static_cast<std::ptrdiff_t>(left + taps.first) * channels;
        for (const float weight : taps.weights) {
          for (int c = 0; c < channels; ++c) row[x * channels + c] += weight * *from++;
        }
      }
    }
  });
  return out;
}

/// One axis on its way down to a coarse grid, across it, and up again. With spacing s between coarse samples, Gaussians
/// of 0.8 s before and after it leave 3e-6 of what could alias.
struct Axis {
  static constexpr double kGuard = 0.8, kSamplesASigma = 2.5;
  Axis(int size, double sigma) {
    const int coarse = std::max(1, static_cast<int>(std::ceil(kSamplesASigma * size / sigma)));
    const double spacing = 1.0 * size / coarse, guard = kGuard * spacing;
    const double middle = std::sqrt(std::max(0.0, sigma * sigma - 2 * guard * guard));
    down = gaussian_taps(size, coarse, guard);
    // One sample is all that a Gaussian of 2.5 sizes and more leaves, however wide: 1e-13 of a wave comes through.
    across = coarse == 1 ? std::vector<Taps>{{0, {1.0f}}} : gaussian_taps(coarse, coarse, middle / spacing);
    up = gaussian_taps(coarse, size, guard / spacing);
  }
  std::vector<Taps> down, across, up;
};

/// Tap by tap, which OpenCV does well.
Image<float> few_taps(View<const float> image, double sigma) {
  const int reach = static_cast<int>(std::ceil(kCut * sigma));
  cv::Mat weights(1, 2 * reach + 1, CV_64F);
  for (int k = -reach; k <= reach; ++k) weights.at<double>(k + reach) = std::exp(-0.5 * std::pow(k / sigma, 2));
  weights /= cv::sum(weights)[0];
  Image<float> out(image.size(), image.channels());
  cv::Mat to = internal::mat_from_view(out.view());
  cv::sepFilter2D(internal::mat_from_view(image), to, -1, weights, weights, {-1, -1}, 0, cv::BORDER_REFLECT);
  return out;
}

Image<float> plane_gaussian(View<const float> image, double sigma) {
  constexpr double kWorthACoarseGrid = 4;
  if (sigma < kWorthACoarseGrid) return few_taps(image, sigma);
  // Columns first and last: between them there are few rows.
  const Axis x(image.width(), sigma), y(image.height(), sigma);
  Image<float> coarse = filter_rows(filter_columns(image, y.down), x.down);
  coarse = filter_rows(filter_columns(coarse, y.across), x.across);
  return filter_columns(filter_rows(coarse, x.up), y.up);
}

Image<float> copy_of(View<const float> image) {
  Image<float> copy(image.size(), image.channels());
  for (int y = 0; y < image.height(); ++y) std::copy_n(image.row(y), copy.row_samples(), copy.row(y));
  return copy;
}

}  // namespace

Image<float> gaussian_blur(View<const float> image, double sigma, Surface surface) {
  if (!(std::isfinite(sigma) && sigma >= 0)) {
    throw Error(fmt::format("a Gaussian's sigma of {} pixels; give a number from 0 on", sigma));
  }
  if (image.empty() || sigma == 0) return copy_of(image);
  return surface == Surface::kLatLong ? internal::sphere_gaussian(image, sigma) : plane_gaussian(image, sigma);
}

}  // namespace hdr
