// resample(): tiles of 32 x 32 pixels, each of which is one polynomial and
// vectors where it lies smoothly in plain pixels of the source, and pixel by
// pixel where it does not.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/probe/internal/contrast.h"
#include "libhdr/probe/internal/coordinates.h"
#include "libhdr/probe/internal/pixel_filter.h"
#include "libhdr/probe/internal/source_picture.h"
#include "libhdr/probe/internal/tile_kernels.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

using namespace internal;

void require_picture(Size size, const char* which) {
  if (size.width > 0 && size.height > 0) return;
  throw Error(fmt::format("resample: the {} picture of {}x{} pixels is empty", which, size.width, size.height));
}

/// Rotations of a rotation's own size, so that unit directions stay unit.
void require_rotation(const Mat3& rotation) {
  constexpr double kTolerance = 1e-6;
  if ((rotation * rotation.transpose()).isIdentity(kTolerance) && rotation.determinant() > 0) return;
  throw Error("resample: the matrix between the axes is not a rotation");
}

/// What all tiles share.
struct Shared {
  Neighbourhood neighbourhood;
  SourcePicture bilinear;
  Contrast contrast;
  Coordinates coordinates;

  Shared(View<const float> source, const Projection& from, const Projection& to, Size size,
         const Mat3& source_from_probe)
      : neighbourhood(source, from),
        bilinear(source, from),
        contrast(neighbourhood),
        coordinates(neighbourhood, to, source_from_probe, size) {}
};

/// The standard deviations of the source.
struct Doubts {
  Neighbourhood neighbourhood;
  SourcePicture bilinear;
  Doubts(View<const float> stddev, const Projection& from) : neighbourhood(stddev, from), bilinear(stddev, from) {}
};

/// One thread's work on tiles of the rows from `first_row` on, which `band` has.
class TileWorker {
 public:
  TileWorker(const Shared& job, const Doubts* doubts, const Resampler::Band& band, int first_row)
      : job_(job),
        band_(band),
        output_(band.values),
        first_row_(first_row),
        filter_(job.neighbourhood, job.bilinear, job.contrast),
        kernels_(job.neighbourhood, job.contrast) {
    if (doubts && !band.stddev.empty()) doubts_.emplace(doubts->neighbourhood, doubts->bilinear, job.contrast);
  }

  /// A tile that bends too much is tried again in quarters, the smallest pixel
  /// by pixel.
  void write(const Tile& tile) {
    constexpr int kSmallest = 8;
    if (job_.coordinates.shows_nothing(tile)) return leave_black(tile);
    if (const auto polynomial = job_.coordinates.polynomial(tile)) return write_smooth(tile, *polynomial);
    if (std::max(tile.width, tile.height) <= kSmallest) return write_exactly(tile);
    const int w = std::max(1, (tile.width + 1) / 2), h = std::max(1, (tile.height + 1) / 2);
    for (int y = 0; y < tile.height; y += h) {
      for (int x = 0; x < tile.width; x += w) {
        write({tile.first_x + x, tile.first_y + y, std::min(w, tile.width - x), std::min(h, tile.height - y)});
      }
    }
  }

 private:
  void write_smooth(const Tile& tile, const TilePolynomial& polynomial) {
    mark(tile, 1);
    kernels_.choose(tile, polynomial, output_.channels() == 3);
    const TilePixels& pixels = kernels_.pixels();
    const View<const float> source = job_.neighbourhood.pixels();
    for (int row = 0; row < tile.height; ++row) {
      float* out = output_.pixel(tile.first_x, tile.first_y - first_row_ + row);
      for (int k = 0; k < tile.width; ++k) {
        const int index = row * Tile::kSide + k;
        if (kernels_.kinds()[index] != KernelKind::kNone) continue;
        filter_.write(polynomial.region, Vec2(pixels.x[index] + 0.5, pixels.y[index] + 0.5), kernels_.shape_of(index),
                      static_cast<double>(pixels.scale[index]), out + k * output_.channels());
      }
      if (doubts_) write_doubts(tile, polynomial.region, row);
      if (output_.channels() != 3) continue;
      filter_row(
          {source.data(), source.width(), source.stride(), &pixels, kernels_.kinds(), row * Tile::kSide, tile.width,
           job_.contrast.nonnegative() ? 0.0f : -std::numeric_limits<float>::infinity(), &kernels_.spline()},
          out);
    }
  }

  /// Under the kernels that the values have.
  void write_doubts(const Tile& tile, int region, int row) {
    const TilePixels& pixels = kernels_.pixels();
    float* out = band_.stddev.pixel(tile.first_x, tile.first_y - first_row_ + row);
    for (int k = 0; k < tile.width; ++k, out += band_.stddev.channels()) {
      const int index = row * Tile::kSide + k;
      const Vec2 px(pixels.x[index] + 0.5, pixels.y[index] + 0.5);
      const KernelKind kind = kernels_.kinds()[index];
      if (kind == KernelKind::kNone) {
        doubts_->write_deviation(region, px, kernels_.shape_of(index), static_cast<double>(pixels.scale[index]), out);
      } else {
        doubts_->write_deviation(kind, region, px, kernels_.shape_of(index), out);
      }
    }
  }

  void mark(const Tile& tile, float shown) {
    if (band_.shown.empty()) return;
    for (int row = 0; row < tile.height; ++row) {
      std::fill_n(band_.shown.pixel(tile.first_x, tile.first_y - first_row_ + row), tile.width, shown);
    }
  }

  void leave_black(const Tile& tile) {
    mark(tile, 0);
    for (int row = 0; doubts_ && row < tile.height; ++row) {
      std::fill_n(band_.stddev.pixel(tile.first_x, tile.first_y - first_row_ + row),
                  tile.width * band_.stddev.channels(), 0.0f);
    }
    for (int row = 0; row < tile.height; ++row) {
      std::fill_n(output_.pixel(tile.first_x, tile.first_y - first_row_ + row), tile.width * output_.channels(), 0.0f);
    }
  }

  void write_exactly(const Tile& tile) {
    for (int row = 0; row < tile.height; ++row) {
      for (int k = 0; k < tile.width; ++k) {
        const int x = tile.first_x + k, y = tile.first_y + row;
        const auto place = job_.coordinates.place(x, y);
        if (!place) {
          leave_black({x, y, 1, 1});
          continue;
        }
        mark({x, y, 1, 1}, 1);
        const int region = job_.neighbourhood.region_of(place->px);
        const KernelShape shape = kernel_shape(place->x_u, place->x_v, place->y_u, place->y_v);
        const double scale = largest_axis(place->x_u, place->x_v, place->y_u, place->y_v);
        filter_.write(region, place->px, shape, scale, output_.pixel(x, y - first_row_));
        if (doubts_) {
          doubts_->write_deviation(region, place->px, shape, scale, band_.stddev.pixel(x, y - first_row_));
        }
      }
    }
  }

  const Shared& job_;
  Resampler::Band band_;
  View<float> output_;
  int first_row_;
  PixelFilter filter_;
  std::optional<PixelFilter> doubts_;
  TileKernels kernels_;
};

/// One or two channels as three, the last repeated: what is vectors for three
/// is so for them.
Image<float> as_three(View<const float> pixels) {
  Image<float> three(pixels.size(), 3);
  const int last = pixels.channels() - 1;
  for_rows(pixels.height(), 16, [&](int first, int end) {
    for (int y = first; y < end; ++y) {
      for (int x = 0; x < pixels.width(); ++x) {
        for (int c = 0; c < 3; ++c) three(x, y, c) = pixels(x, y, std::min(c, last));
      }
    }
  });
  return three;
}

void copy_first_channels(View<const float> three, View<float> some) {
  for (int y = 0; y < some.height(); ++y) {
    for (int x = 0; x < some.width(); ++x) std::copy_n(three.pixel(x, y), some.channels(), some.pixel(x, y));
  }
}

}  // namespace

struct Resampler::Job {
  Image<float> three;  ///< of a source with fewer channels
  Size size;
  Shared shared;
  std::optional<Doubts> doubts;

  Job(View<const float> source, const Projection& from, const Projection& to, Size output_size,
      const Mat3& source_from_probe, View<const float> stddev)
      : three(source.channels() < 3 ? as_three(source) : Image<float>()),
        size(output_size),
        shared(three.empty() ? source : three.view(), from, to, output_size, source_from_probe) {
    if (!stddev.empty()) doubts.emplace(stddev, from);
  }

  /// All tiles of one row of them.
  void write(const Band& band, int first_row) const {
    TileWorker worker(shared, doubts ? &*doubts : nullptr, band, first_row);
    for (int x = 0; x < size.width; x += Tile::kSide) {
      worker.write({x, first_row, std::min(Tile::kSide, size.width - x), band.values.height()});
    }
  }
};

Resampler::Resampler(View<const float> source, const Projection& from, const Projection& to, Size size,
                     const Mat3& source_from_probe, View<const float> stddev) {
  require_picture(source.size(), "source");
  HDR_ASSERT(stddev.empty() || stddev.size() == source.size());
  require_picture(size, "output");
  require_valid(from);
  require_valid(to);
  require_rotation(source_from_probe);
  job_ = std::make_unique<const Job>(source, from, to, size, source_from_probe, stddev);
}

Resampler::~Resampler() = default;

void Resampler::rows(int first, const Band& band) const {
  static_assert(kGrain == Tile::kSide);
  const View<float>& values = band.values;
  HDR_ASSERT(first % kGrain == 0 && first + values.height() <= job_->size.height && values.width() == job_->size.width);
  for_rows(values.height(), kGrain, [&](int begin, int end) {
    const auto part_of = [&](const View<float>& plane) { return plane.empty() ? plane : plane.rows(begin, end); };
    Band part{part_of(values), part_of(band.shown), part_of(band.stddev)};
    if (job_->three.empty()) return job_->write(part, first + begin);
    Image<float> wide(part.values.size(), 3);
    const View<float> some = part.values;
    part.values = wide;
    job_->write(part, first + begin);
    copy_first_channels(wide, some);
  });
}

Image<float> resample(View<const float> source, const Projection& from, const Projection& to, Size size,
                      const Mat3& source_from_probe) {
  const Resampler resampler(source, from, to, size, source_from_probe);
  Image<float> output(size, source.channels());
  resampler.rows(0, output);
  return output;
}

}  // namespace hdr
