#pragma once
// Image<T> owns pixels, View<T> borrows them. Samples are interleaved (R G B R G B ...), rows run from top to bottom,
// and each row of an Image starts on a 64-byte boundary so that SIMD loads need no special first step. Copies are
// explicit: Image is move-only and has clone(). A cv::Mat or an OIIO span over the same memory is made at the edges
// (core/internal), so nothing is copied to change library.
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>

#include "libhdr/core/error.h"
#include "libhdr/core/pixel_memory.h"

namespace hdr {

struct Size {
  int width = 0;
  int height = 0;
  bool operator==(const Size&) const = default;
};

/// Borrowed pixels. `stride` is the distance between rows in samples (not bytes). View<const T> is read-only.
template <class T>
class View {
 public:
  View() = default;
  View(T* data, int width, int height, int channels, std::ptrdiff_t stride)
      : data_(data), width_(width), height_(height), channels_(channels), stride_(stride) {
    HDR_ASSERT(width >= 0 && height >= 0 && channels >= 0);
    HDR_ASSERT(stride >= static_cast<std::ptrdiff_t>(width) * channels);
  }
  operator View<const T>() const requires(!std::is_const_v<T>) { return {data_, width_, height_, channels_, stride_}; }

  T* data() const { return data_; }
  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  std::ptrdiff_t stride() const { return stride_; }
  Size size() const { return {width_, height_}; }
  bool empty() const { return width_ == 0 || height_ == 0; }

  T* row(int y) const { return data_ + y * stride_; }
  T* pixel(int x, int y) const { return row(y) + static_cast<std::ptrdiff_t>(x) * channels_; }
  T& operator()(int x, int y, int channel = 0) const { return pixel(x, y)[channel]; }

  View rows(int first, int last) const { return {row(first), width_, last - first, channels_, stride_}; }

 private:
  T* data_ = nullptr;
  int width_ = 0;
  int height_ = 0;
  int channels_ = 0;
  std::ptrdiff_t stride_ = 0;
};

/// Owned pixels, zero when made. Throws std::bad_alloc for more than there is memory for.
template <class T>
class Image {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  static constexpr std::size_t kAlignment = 64;

  Image() = default;
  Image(int width, int height, int channels)
      : view_(allocate(width, height, channels)), owned_(view_.data(), Free{bytes_of(height, view_.stride())}) {}
  Image(Size size, int channels) : Image(size.width, size.height, channels) {}

  Image(Image&& other) noexcept : view_(other.view_), owned_(std::move(other.owned_)) { other.view_ = {}; }
  Image& operator=(Image&& other) noexcept {
    owned_ = std::move(other.owned_);
    view_ = other.view_;
    if (this != &other) other.view_ = {};
    return *this;
  }

  Image clone() const {
    Image copy(width(), height(), channels());
    for (int y = 0; y < height(); ++y) std::memcpy(copy.row(y), row(y), row_samples() * sizeof(T));
    return copy;
  }

  View<T> view() { return view_; }
  View<const T> view() const { return view_; }
  operator View<T>() { return view_; }
  operator View<const T>() const { return view_; }

  int width() const { return view_.width(); }
  int height() const { return view_.height(); }
  int channels() const { return view_.channels(); }
  Size size() const { return view_.size(); }
  bool empty() const { return view_.empty(); }
  std::ptrdiff_t stride() const { return view_.stride(); }
  std::size_t row_samples() const { return static_cast<std::size_t>(width()) * static_cast<std::size_t>(channels()); }

  T* row(int y) { return view_.row(y); }
  const T* row(int y) const { return view_.row(y); }
  T* pixel(int x, int y) { return view_.pixel(x, y); }
  const T* pixel(int x, int y) const { return view_.pixel(x, y); }
  T& operator()(int x, int y, int channel = 0) { return view_(x, y, channel); }
  const T& operator()(int x, int y, int channel = 0) const { return view_(x, y, channel); }

 private:
  struct Free {
    std::size_t bytes = 0;
    void operator()(T* p) const { free_pixels(p, bytes); }
  };

  /// The greatest number where 64 bits do not hold it: allocate_pixels refuses that as it does what no machine has.
  static std::size_t bytes_of(int height, std::ptrdiff_t stride) {
    std::size_t samples = 0, bytes = 0;
    if (__builtin_mul_overflow(static_cast<std::size_t>(stride), static_cast<std::size_t>(height), &samples) ||
        __builtin_mul_overflow(samples, sizeof(T), &bytes)) {
      return std::numeric_limits<std::size_t>::max();
    }
    return bytes;
  }

  static View<T> allocate(int width, int height, int channels) {
    HDR_ASSERT(width >= 0 && height >= 0 && channels >= 0);
    const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(kAlignment / sizeof(T) == 0 ? 1 : kAlignment / sizeof(T));
    const std::ptrdiff_t samples = static_cast<std::ptrdiff_t>(width) * channels;
    const std::ptrdiff_t stride = (samples + step - 1) / step * step;
    T* data = static_cast<T*>(allocate_pixels(bytes_of(height, stride)));
    return {data, width, height, channels, stride};
  }

  View<T> view_;
  std::unique_ptr<T[], Free> owned_;
};

}  // namespace hdr
