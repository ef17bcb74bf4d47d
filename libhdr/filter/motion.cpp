#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/filter/blur.h"

namespace hdr {
namespace {

/// A run of weights along one row of the kernel.
struct KernelRow {
  int dy = 0, first_dx = 0;
  std::vector<double> weights;
};

/// How long the segment stays in each pixel, as a share of its length: cut where it crosses from one to the next.
std::vector<KernelRow> segment_kernel(double length, double degrees) {
  // Exact where a quarter turn makes them so: cos(90 degrees) is not 6e-17.
  const double turn = std::remainder(degrees, 360);
  const bool along_x = std::remainder(turn, 180) == 0, along_y = std::remainder(turn - 90, 180) == 0;
  const double dx = along_y ? 0 : along_x ? 1 : std::cos(turn * kDegree);
  const double dy = along_x ? 0 : along_y ? 1 : -std::sin(turn * kDegree);  // y points down
  std::vector<double> cuts = {-length / 2, length / 2};
  for (const double slope : {dx, dy}) {
    const int reach = static_cast<int>(std::floor(std::abs(slope) * length / 2 + 0.5));
    for (int k = -reach; k < reach; ++k) cuts.push_back(std::clamp((k + 0.5) / slope, -length / 2, length / 2));
  }
  std::sort(cuts.begin(), cuts.end());
  std::map<std::pair<int, int>, double> weights;  // by (dy, dx)
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double middle = (cuts[k + 1] + cuts[k]) / 2;
    const std::pair<int, int> pixel(static_cast<int>(std::lround(middle * dy)),
                                    static_cast<int>(std::lround(middle * dx)));
    if (cuts[k + 1] > cuts[k]) weights[pixel] += (cuts[k + 1] - cuts[k]) / length;
  }
  std::vector<KernelRow> rows;
  for (const auto& [at, weight] : weights) {
    constexpr double kRounding = 1e-12;  // where a line passes through corners
    if (weight < kRounding) continue;
    if (rows.empty() || rows.back().dy != at.first) rows.push_back({at.first, at.second, {}});
    rows.back().weights.resize(static_cast<std::size_t>(at.second - rows.back().first_dx), 0.0);
    rows.back().weights.push_back(weight);
  }
  return rows;
}

/// The picture with `margin` columns on either side, so that a row can be read shifted. On the sphere half a turn more,
/// for rows beyond a pole.
class Padded {
 public:
  Padded(View<const float> image, int margin, Surface surface)
      : width_(image.width()),
        height_(image.height()),
        channels_(image.channels()),
        margin_(margin),
        surface_(surface) {
    const int half_turn = surface == Surface::kLatLong ? width_ / 2 : 0;
    pixels_ = Image<float>(width_ + 2 * margin + half_turn, height_, channels_);
    for_rows(height_, 16, [&](int first, int last) {
      for (int y = first; y < last; ++y) {
        for (int x = 0; x < pixels_.width(); ++x) {
          std::copy_n(image.pixel(column(x - margin), y), channels_, pixels_.pixel(x, y));
        }
      }
    });
  }
  /// Samples of row y (any number) from column dx on; dx from -margin to margin.
  const float* row(int y, int dx) const {
    const int period = 2 * height_;
    const int k = ((y % period) + period) % period;
    const bool beyond_a_pole = k >= height_ && surface_ == Surface::kLatLong;
    return pixels_.pixel(margin_ + dx + (beyond_a_pole ? width_ / 2 : 0), k < height_ ? k : period - 1 - k);
  }

 private:
  int column(int x) const {
    const int period = surface_ == Surface::kLatLong ? width_ : 2 * width_;
    const int k = ((x % period) + period) % period;
    return k < width_ ? k : period - 1 - k;
  }

  int width_, height_, channels_, margin_;
  Surface surface_;
  Image<float> pixels_;
};

/// A sum that terms enter and leave: what each addition rounds away is kept [Knuth97, 4.2.2 B]. A sun that has passed
/// leaves 1e-32 of itself behind, not 1e-16, which would outshine the dark beside it.
class RunningSum {
 public:
  void add(double term) {
    const double sum = high_ + term, share = sum - high_;
    low_ += (high_ - (sum - share)) + (term - share);
    high_ = sum;
  }
  double value() const { return high_ + low_; }

 private:
  double high_ = 0, low_ = 0;
};

/// A row of equal weights, but for its ends, is a difference of running sums.
void add_running(const Padded& in, int y, const KernelRow& kernel, int width, int channels, std::vector<double>& out) {
  const std::size_t n = kernel.weights.size();
  const double inner = kernel.weights[n / 2];
  std::vector<double> extra = kernel.weights;
  for (double& weight : extra) weight -= inner;
  const float* from = in.row(y + kernel.dy, kernel.first_dx);
  const auto step = static_cast<std::size_t>(channels);
  for (std::size_t c = 0; c < step; ++c) {
    RunningSum sum;
    for (std::size_t k = 0; k < n; ++k) sum.add(from[k * step + c]);
    for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
      double value = inner * sum.value();
      for (std::size_t k = 0; k < n; ++k) {
        if (k == 1 && n > 2) k = n - 1;  // all but those at the ends are equal
        value += extra[k] * from[(x + k) * step + c];
      }
      out[x * step + c] += value;
      if (x + 1 == static_cast<std::size_t>(width)) break;
      sum.add(from[(x + n) * step + c]);
      sum.add(-from[x * step + c]);
    }
  }
}

/// Weight by weight; a block of the row at a time, which stays in the cache.
void add_shifted(const Padded& in, int y, const std::vector<KernelRow>& kernel, std::size_t samples, int channels,
                 float* out) {
  constexpr std::size_t kBlock = 1024;
  for (std::size_t left = 0; left < samples; left += kBlock) {
    const std::size_t count = std::min(kBlock, samples - left);
    float sums[kBlock] = {};
    for (const KernelRow& row : kernel) {
      const float* from = in.row(y + row.dy, row.first_dx) + left;
      for (std::size_t k = 0; k < row.weights.size(); ++k, from += channels) {
        const auto weight = static_cast<float>(row.weights[k]);
        for (std::size_t i = 0; i < count; ++i) sums[i] += weight * from[i];
      }
    }
    std::copy_n(sums, count, out + left);
  }
}

}  // namespace

Image<float> motion_blur(View<const float> image, double length, double degrees, Surface surface) {
  constexpr double kLongest = 20000;
  if (!(length >= 0 && length <= kLongest && std::isfinite(degrees))) {
    throw Error(
        fmt::format("a motion of {} pixels at {} degrees; give a length from 0 to {}", length, degrees, kLongest));
  }
  Image<float> out(image.size(), image.channels());
  if (length == 0 || image.empty()) {
    for (int y = 0; y < image.height(); ++y) std::copy_n(image.row(y), out.row_samples(), out.row(y));
    return out;
  }
  const std::vector<KernelRow> kernel = segment_kernel(length, degrees);
  int margin = 0;
  for (const KernelRow& row : kernel) {
    margin = std::max({margin, -row.first_dx, row.first_dx + static_cast<int>(row.weights.size())});
  }
  const Padded padded(image, margin, surface);
  const bool is_one_row = kernel.size() == 1;
  for_rows(image.height(), 8, [&](int first, int last) {
    std::vector<double> sums(out.row_samples());
    for (int y = first; y < last; ++y) {
      if (!is_one_row) {
        add_shifted(padded, y, kernel, out.row_samples(), image.channels(), out.row(y));
        continue;
      }
      std::fill(sums.begin(), sums.end(), 0.0);
      add_running(padded, y, kernel.front(), image.width(), image.channels(), sums);
      std::copy(sums.begin(), sums.end(), out.row(y));
    }
  });
  return out;
}

}  // namespace hdr
