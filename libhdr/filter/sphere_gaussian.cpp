// The Gaussian of the sphere, row by row. For directions at polar angles t1, t2 and azimuths f apart,
//   cos angle - 1 = -2 sin^2((t1 - t2)/2) - sin t1 sin t2 (1 - cos f),
// so the kernel exp((cos angle - 1)/s^2) is a factor of the two rows times a convolution along them, exp(-a (1 - cos
// f)) with a = sin t1 sin t2 / s^2, whose Fourier coefficients are the modified Bessel functions exp(-a) I_m(a). Of a
// row, modes up to some 9 sin t / s matter, and of the rows those within 6 s: the work does not depend on s.
#include "libhdr/filter/internal/sphere_gaussian.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr::internal {
namespace {

constexpr int kLanes = 4;   ///< rows whose Bessel functions are made side by side
constexpr double kCut = 6;  ///< sigmas
constexpr int kRowsAtATime = 16;

/// The spectra of exp(-a (1 - cos f)) sampled at `width` azimuths, for kLanes values of a: modes 0 to width / 2,
/// divided by width. Mode m of the function itself is exp(-a) I_m(a), by Miller's downward recurrence
/// [Abramowitz64, 9.6.26 and 9.6.37]: I_(m-1) = I_(m+1) + (2m/a) I_m, scaled so that exp(-a) (I_0 + 2 I_1 + 2 I_2 +
/// ...) = 1. Sampling adds to it the modes that it takes for m: width - m, width + m, 2 width - m ...
class RowKernels {
 public:
  /// `largest_a` that will come.
  RowKernels(int width, double largest_a)
      : width_(width), values_(static_cast<std::size_t>(start_of(largest_a) + 1) * kLanes) {}

  /// Returns how many modes are not negligible, at most `modes`.
  int compute(const double (&a)[kLanes], int modes) {
    const int start = start_of(*std::max_element(std::begin(a), std::end(a)));
    double above[kLanes] = {}, here[kLanes], sum[kLanes] = {}, two_over_a[kLanes];
    for (int k = 0; k < kLanes; ++k) {
      constexpr double kFlat = 1e-10;  // below it I_0 = 1 and the others are 0, to the last digit
      two_over_a[k] = 2 / std::max(a[k], kFlat);
      here[k] = 1e-60;
    }
    for (int m = start; m > 0; --m) {
      double* out = at(m);
      double largest = 0;
      for (int k = 0; k < kLanes; ++k) {
        out[k] = here[k];
        sum[k] += here[k];
        const double below = above[k] + m * two_over_a[k] * here[k];
        above[k] = here[k];
        here[k] = below;
        largest = std::max(largest, below);
      }
      constexpr double kHuge = 1e200;  // small arguments grow fast downwards; what has been is nothing then
      if (largest > kHuge) rescale(m, start, above, here, sum);
    }
    for (int k = 0; k < kLanes; ++k) {
      at(0)[k] = here[k];
      scale_[k] = 1 / (here[k] + 2 * sum[k]);
    }
    for (int m = 0; m < std::min(modes, start + 1); ++m) fold(m, start);
    return std::min(modes, start + 1);
  }
  double value(int m, int lane) const { return values_[static_cast<std::size_t>(m * kLanes + lane)] * scale_[lane]; }

 private:
  /// exp(-a) I_m(a) is about exp(-m^2 / 2a): from here on below 4e-18 of I_0.
  static int start_of(double a) { return static_cast<int>(std::sqrt(2 * 40 * a)) + 24; }
  double* at(int m) { return &values_[static_cast<std::size_t>(m) * kLanes]; }

  void rescale(int m, int start, double (&above)[kLanes], double (&here)[kLanes], double (&sum)[kLanes]) {
    for (int k = 0; k < kLanes; ++k) {
      const double by = 1 / std::max(here[k], 1.0);
      above[k] *= by;
      here[k] *= by;
      sum[k] *= by;
      for (int n = m; n <= start; ++n) at(n)[k] *= by;
    }
  }

  /// m is at most width / 2: what is added lies above it, and for m = width / 2 it is m itself once more.
  void fold(int m, int start) {
    for (int k = 0; k < kLanes; ++k) {
      double sum = at(m)[k];
      for (int period = width_; period - m <= start; period += width_) {
        sum += at(period - m)[k];
        if (period + m <= start) sum += at(period + m)[k];
      }
      at(m)[k] = sum;
    }
  }

  int width_;
  std::vector<double> values_;
  double scale_[kLanes] = {};
};

/// Modes 0 .. modes - 1 of every row: for each row and channel the real parts, then the imaginary ones.
class Spectra {
 public:
  Spectra(int rows, int channels, int modes)
      : channels_(channels),
        modes_(modes),
        values_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(2 * channels * modes)) {}
  double* row(int y) { return values_.data() + static_cast<std::ptrdiff_t>(y) * stride(); }
  const double* row(int y) const { return values_.data() + static_cast<std::ptrdiff_t>(y) * stride(); }
  int stride() const { return 2 * channels_ * modes_; }
  int channels() const { return channels_; }
  int modes() const { return modes_; }

 private:
  int channels_, modes_;
  std::vector<double> values_;
};

/// OpenCV packs the spectrum of n real samples as Re0, Re1, Im1, Re2, Im2, ... and for even n Re(n/2) at the end.
void unpack(const double* packed, int n, int modes, double* real, double* imaginary) {
  real[0] = packed[0];
  for (int m = 1; m < modes; ++m) {
    real[m] = packed[2 * m - 1];
    imaginary[m] = 2 * m < n ? packed[2 * m] : 0;
  }
}
void pack(const double* real, const double* imaginary, int n, int modes, double* packed) {
  packed[0] = real[0];
  for (int m = 1; m < modes; ++m) {
    packed[2 * m - 1] = real[m];
    if (2 * m < n) packed[2 * m] = imaginary[m];
  }
}

Spectra spectra_of(View<const float> map, int modes) {
  Spectra spectra(map.height(), map.channels(), modes);
  const int channels = map.channels(), width = map.width();
  for_rows(map.height(), kRowsAtATime, [&](int first, int last) {
    cv::Mat rows((last - first) * channels, width, CV_64F), packed;
    for (int y = first; y < last; ++y) {
      for (int c = 0; c < channels; ++c) {
        auto* to = rows.ptr<double>((y - first) * channels + c);
        for (int x = 0; x < width; ++x) to[x] = map(x, y, c);
      }
    }
    cv::dft(rows, packed, cv::DFT_ROWS);
    for (int y = first; y < last; ++y) {
      for (int c = 0; c < channels; ++c) {
        double* real = spectra.row(y) + 2 * c * modes;
        unpack(packed.ptr<double>((y - first) * channels + c), width, modes, real, real + modes);
      }
    }
  });
  return spectra;
}

struct Kernel {
  Kernel(int height, double s)
      : per_s2(1 / (s * s)), reach(static_cast<int>(std::min(std::ceil(kCut * s * height / kPi), 1.0 * height))) {
    for (int y = 0; y < height; ++y) {
      polar.push_back(kPi * (y + 0.5) / height);
      sine.push_back(std::sin(polar.back()));
      solid_angle.push_back(std::cos(kPi * y / height) - std::cos(kPi * (y + 1) / height));
    }
  }
  double rows_factor(int y1, int y2) const {
    const double half = std::sin(0.5 * (polar[static_cast<std::size_t>(y1)] - polar[static_cast<std::size_t>(y2)]));
    return std::exp(-2 * half * half * per_s2) * solid_angle[static_cast<std::size_t>(y2)];
  }
  double a(int y1, int y2) const {
    return sine[static_cast<std::size_t>(y1)] * sine[static_cast<std::size_t>(y2)] * per_s2;
  }

  double per_s2;
  int reach;
  std::vector<double> polar, sine, solid_angle;
};

/// The spectrum of output row y into `out`.
void blur_row(const Spectra& spectra, const Kernel& kernel, int y, int height, RowKernels& kernels, double* out) {
  const int modes = spectra.modes(), planes = 2 * spectra.channels();
  std::fill_n(out, spectra.stride(), 0.0);
  std::vector<double> weights(static_cast<std::size_t>(modes));
  double total = 0;
  const int first = std::max(0, y - kernel.reach), last = std::min(height, y + kernel.reach + 1);
  for (int group = first; group < last; group += kLanes) {
    double a[kLanes];
    for (int k = 0; k < kLanes; ++k) a[k] = kernel.a(y, std::min(group + k, last - 1));
    const int used = kernels.compute(a, modes);
    for (int k = 0; k < std::min(kLanes, last - group); ++k) {
      const double factor = kernel.rows_factor(y, group + k);
      total += factor * kernels.value(0, k);
      for (int m = 0; m < used; ++m) weights[static_cast<std::size_t>(m)] = factor * kernels.value(m, k);
      const double* in = spectra.row(group + k);
      for (int p = 0; p < planes; ++p) {
        const double* from = in + p * modes;
        double* to = out + p * modes;
        for (int m = 0; m < used; ++m) to[m] += weights[static_cast<std::size_t>(m)] * from[m];
      }
    }
  }
  for (int k = 0; k < spectra.stride(); ++k) out[k] /= total;
}

float least_of(View<const float> map) {
  float least = map(0, 0);
  for (int y = 0; y < map.height(); ++y) {
    const float* row = map.row(y);
    least = std::min(least, *std::min_element(row, row + static_cast<std::ptrdiff_t>(map.width()) * map.channels()));
  }
  return least;
}

}  // namespace

Image<float> sphere_gaussian(View<const float> map, double sigma) {
  const int width = map.width(), height = map.height(), channels = map.channels();
  constexpr double kNarrowest = 0.05;  // pixels: all that is left is the pixel itself
  const double s = std::max(sigma, kNarrowest) * 2 * kPi / width;
  // exp(-a) I_m(a) falls like exp(-m^2 / 2a), and a is 1/s^2 at most.
  const int modes = static_cast<int>(std::min<double>(width / 2 + 1, std::ceil(9 / s) + 24));
  const Spectra spectra = spectra_of(map, modes);
  const Kernel kernel(height, s);
  // A mean is not below the least: what is (1e-16 of the brightest light) is the rounding of its waves.
  const float least = least_of(map);
  Image<float> out(map.size(), channels);
  for_rows(height, kRowsAtATime, [&](int first, int last) {
    RowKernels kernels(width, kernel.per_s2);
    std::vector<double> blurred(static_cast<std::size_t>(spectra.stride()));
    cv::Mat packed = cv::Mat::zeros((last - first) * channels, width, CV_64F), rows;
    for (int y = first; y < last; ++y) {
      blur_row(spectra, kernel, y, height, kernels, blurred.data());
      for (int c = 0; c < channels; ++c) {
        const double* real = blurred.data() + 2 * c * modes;
        pack(real, real + modes, width, modes, packed.ptr<double>((y - first) * channels + c));
      }
    }
    cv::dft(packed, rows, cv::DFT_ROWS | cv::DFT_INVERSE | cv::DFT_REAL_OUTPUT | cv::DFT_SCALE);
    for (int y = first; y < last; ++y) {
      for (int c = 0; c < channels; ++c) {
        const auto* from = rows.ptr<double>((y - first) * channels + c);
        for (int x = 0; x < width; ++x) out(x, y, c) = std::max(least, static_cast<float>(from[x]));
      }
    }
  });
  return out;
}

}  // namespace hdr::internal
