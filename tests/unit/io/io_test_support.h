#pragma once
#include <algorithm>
#include <functional>
#include <string>

#include "libhdr/core/error.h"
#include "libhdr/core/photo.h"
#include "libhdr/core/random.h"
#include "tests/support/support.h"

namespace hdr::test {

/// The message of the Error that `work` throws; empty when it throws none.
inline std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

/// Noise around a bright-to-dark ramp, seeded: a picture with all codes, that JPEG cannot make small.
inline Photo made_up_photo(int width, int height, int bits, std::uint64_t seed, Exposure exposure = {}) {
  Photo photo;
  photo.exposure = exposure;
  photo.bits = bits;
  Random random(seed, 0);
  const auto fill = [&](auto image) {
    using Code = std::remove_reference_t<decltype(image(0, 0))>;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < 3; ++c) {
          const double value = (x + 0.5) / width + 0.1 * random.normal() + 0.05 * c;
          image(x, y, c) = static_cast<Code>(std::clamp(value, 0.0, 1.0) * photo.max_code());
        }
      }
    }
    photo.codes = std::move(image);
  };
  if (bits == 8) {
    fill(Image<std::uint8_t>(width, height, 3));
  } else {
    fill(Image<std::uint16_t>(width, height, 3));
  }
  return photo;
}

template <class T>
std::int64_t differing_samples(const Image<T>& a, const Image<T>& b) {
  if (a.size() != b.size() || a.channels() != b.channels()) return -1;
  std::int64_t differing = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (std::size_t i = 0; i < a.row_samples(); ++i) differing += a.row(y)[i] != b.row(y)[i];
  }
  return differing;
}

}  // namespace hdr::test
