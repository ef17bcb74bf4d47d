// resample(): tiles of 32 x 32 pixels, each of which is one polynomial and
// vectors where it lies smoothly in plain pixels of the source, and pixel by
// pixel where it does not.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

/// One thread's work on tiles of the rows from `first_row` on, which `output` has.
class TileWorker {
 public:
  TileWorker(const Shared& job, View<float> output, int first_row)
      : job_(job),
        output_(output),
        first_row_(first_row),
        filter_(job.neighbourhood, job.bilinear, job.contrast),
        kernels_(job.neighbourhood, job.contrast) {}

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
      if (output_.channels() != 3) continue;
      filter_row({source.data(), source.stride(), &pixels, kernels_.kinds(), row * Tile::kSide, tile.width,
                  job_.contrast.nonnegative() ? 0.0f : -std::numeric_limits<float>::infinity(), &kernels_.spline()},
                 out);
    }
  }

  void leave_black(const Tile& tile) {
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
        filter_.write(job_.neighbourhood.region_of(place->px), place->px,
                      kernel_shape(place->x_u, place->x_v, place->y_u, place->y_v),
                      largest_axis(place->x_u, place->x_v, place->y_u, place->y_v), output_.pixel(x, y - first_row_));
      }
    }
  }

  const Shared& job_;
  View<float> output_;
  int first_row_;
  PixelFilter filter_;
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

  Job(View<const float> source, const Projection& from, const Projection& to, Size output_size,
      const Mat3& source_from_probe)
      : three(source.channels() < 3 ? as_three(source) : Image<float>()),
        size(output_size),
        shared(three.empty() ? source : three.view(), from, to, output_size, source_from_probe) {}

  /// All tiles of one row of them.
  void write(View<float> band, int first_row) const {
    TileWorker worker(shared, band, first_row);
    for (int x = 0; x < size.width; x += Tile::kSide) {
      worker.write({x, first_row, std::min(Tile::kSide, size.width - x), band.height()});
    }
  }
};

Resampler::Resampler(View<const float> source, const Projection& from, const Projection& to, Size size,
                     const Mat3& source_from_probe) {
  require_picture(source.size(), "source");
  require_picture(size, "output");
  require_valid(from);
  require_valid(to);
  require_rotation(source_from_probe);
  job_ = std::make_unique<const Job>(source, from, to, size, source_from_probe);
}

Resampler::~Resampler() = default;

void Resampler::rows(int first, View<float> band) const {
  static_assert(kGrain == Tile::kSide);
  HDR_ASSERT(first % kGrain == 0 && first + band.height() <= job_->size.height && band.width() == job_->size.width);
  for_rows(band.height(), kGrain, [&](int begin, int end) {
    const View<float> part = band.rows(begin, end);
    if (job_->three.empty()) return job_->write(part, first + begin);
    Image<float> wide(part.size(), 3);
    job_->write(wide, first + begin);
    copy_first_channels(wide, part);
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
