#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/io/internal/exif.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/sphere_file.h"
#include "libhdr/io/read.h"

namespace hdr {
namespace {

struct Statistics {
  double sum = 0, min = std::numeric_limits<double>::infinity(), max = -min, smallest_positive = min;
  std::int64_t finite = 0, nan = 0, infinite = 0, negative = 0;

  void add(double value) {
    if (std::isnan(value)) {
      ++nan;
    } else if (std::isinf(value)) {
      ++infinite;
    } else {
      ++finite;
      sum += value;
      min = std::min(min, value);
      max = std::max(max, value);
      if (value < 0) ++negative;
      if (value > 0) smallest_positive = std::min(smallest_positive, value);
    }
  }

  void join(const Statistics& part) {
    sum += part.sum;
    min = std::min(min, part.min);
    max = std::max(max, part.max);
    smallest_positive = std::min(smallest_positive, part.smallest_positive);
    finite += part.finite;
    nan += part.nan;
    infinite += part.infinite;
    negative += part.negative;
  }
};

/// Integer samples come as fractions of the full scale; codes are told as codes.
double scale_of(const OIIO::ImageSpec& spec) {
  if (!spec.format.is_floating_point()) {
    const double bits = 8.0 * static_cast<double>(spec.format.basesize());
    return std::exp2(spec.format.is_signed() ? bits - 1 : bits) - 1;
  }
  return 1.0;
}

Statistics statistics_of(const Image<float>& image, double scale) {
  const auto of_rows = [&](int first, int last) {
    Statistics part;
    for (int y = first; y < last; ++y) {
      for (const float* v = image.row(y); v != image.row(y) + image.row_samples(); ++v) part.add(scale * *v);
    }
    return part;
  };
  return reduce_rows(image.height(), 16, Statistics{}, of_rows,
                     [](Statistics& total, const Statistics& part) { total.join(part); });
}

}  // namespace

FileInfo read_info(const Path& path) try {
  const auto input = internal::open_picture(path);
  const OIIO::ImageSpec spec = input->spec();
  const Statistics s = statistics_of(internal::read_floats(*input, path), scale_of(spec));
  FileInfo info;
  info.path = path;
  info.format = input->format_name();
  info.type = spec.format.c_str();
  info.compression = spec.get_string_attribute("compression");
  info.projection = internal::projection_text(spec);
  info.width = internal::upright_size(spec).width;
  info.height = internal::upright_size(spec).height;
  info.channels = spec.nchannels;
  if (const float white = spec.get_float_attribute("whiteLuminance", 0); white > 0) info.white_luminance = white;
  info.exposure = internal::exposure_from_exif(*input, path);
  if (s.finite > 0) {
    info.min = s.min;
    info.max = s.max;
    info.mean = s.sum / static_cast<double>(s.finite);
    if (s.max > 0) info.stops = std::log2(s.max / s.smallest_positive);
  }
  info.nan = s.nan;
  info.inf = s.infinite;
  info.negative = s.negative;
  return info;
} catch (const std::bad_alloc&) {
  throw Error(path.string() + ": does not fit in memory; scale it down");
}

}  // namespace hdr
