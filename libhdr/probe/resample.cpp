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
#include "libhdr/probe/internal/kernel.h"
#include "libhdr/probe/internal/pixel_filter.h"
#include "libhdr/probe/internal/source_picture.h"
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
      : job_(job), output_(output), first_row_(first_row), filter_(job.neighbourhood, job.bilinear, job.contrast) {}

  /// A tile that bends too much is tried again in quarters, the smallest pixel
  /// by pixel.
  void write(const Tile& tile) {
    constexpr int kSmallest = 8;
    if (job_.coordinates.shows_nothing(tile)) return;
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
  /// A rectangle of the pixels that place_tile() has placed.
  struct Part {
    int x, y, width, height;
  };

  void write_smooth(const Tile& tile, const TilePolynomial& polynomial) {
    const TileBounds bounds = place_tile(polynomial, tile, pixels_);
    choose_kernels(polynomial.region, {0, 0, tile.width, tile.height}, bounds);
    const View<const float> source = job_.neighbourhood.pixels();
    for (int row = 0; row < tile.height; ++row) {
      float* out = output_.pixel(tile.first_x, tile.first_y - first_row_ + row);
      for (int k = 0; k < tile.width; ++k) {
        const int index = row * Tile::kSide + k;
        if (kinds_[index] != KernelKind::kNone) continue;
        filter_.write(polynomial.region, Vec2(pixels_.x[index] + 0.5, pixels_.y[index] + 0.5), shape_of(index),
                      static_cast<double>(pixels_.scale[index]), out + k * output_.channels());
      }
      if (output_.channels() != 3) continue;
      filter_row({source.data(), source.stride(), &pixels_, kinds_, row * Tile::kSide, tile.width,
                  job_.contrast.nonnegative() ? 0.0f : -std::numeric_limits<float>::infinity()},
                 out);
    }
  }

  /// For all of a part where that may be, else for its quarters, in the end for
  /// each pixel.
  void choose_kernels(int region, const Part& part, const TileBounds& bounds) {
    constexpr int kSmallest = 8;
    const bool vectors = output_.channels() == 3;
    const bool interpolated = vectors && may_interpolate(region, part, bounds);
    if (!interpolated && vectors && std::max(part.width, part.height) > kSmallest) {
      const int w = (part.width + 1) / 2, h = (part.height + 1) / 2;
      for (int y = 0; y < part.height; y += h) {
        for (int x = 0; x < part.width; x += w) {
          const Part quarter{part.x + x, part.y + y, std::min(w, part.width - x), std::min(h, part.height - y)};
          choose_kernels(region, quarter, bounds_of(quarter));
        }
      }
      return;
    }
    for (int y = part.y; y < part.y + part.height; ++y) {
      for (int x = part.x; x < part.x + part.width; ++x) {
        const int index = y * Tile::kSide + x;
        kinds_[index] = interpolated ? KernelKind::kInterpolated : vectors ? kind_of(region, index) : KernelKind::kNone;
      }
    }
  }

  TileBounds bounds_of(const Part& part) const {
    constexpr float kFar = 1e9f;
    TileBounds b{kFar, kFar, -kFar, -kFar, 0};
    for (int y = part.y; y < part.y + part.height; ++y) {
      for (int index = y * Tile::kSide + part.x; index < y * Tile::kSide + part.x + part.width; ++index) {
        b = {std::min(b.x0, pixels_.x[index]), std::min(b.y0, pixels_.y[index]), std::max(b.x1, pixels_.x[index]),
             std::max(b.y1, pixels_.y[index]), std::max(b.scale, pixels_.scale[index])};
      }
    }
    return b;
  }

  void write_exactly(const Tile& tile) {
    for (int row = 0; row < tile.height; ++row) {
      for (int k = 0; k < tile.width; ++k) {
        const int x = tile.first_x + k, y = tile.first_y + row;
        const auto place = job_.coordinates.place(x, y);
        if (!place) continue;
        filter_.write(job_.neighbourhood.region_of(place->px), place->px,
                      kernel_shape(place->x_u, place->x_v, place->y_u, place->y_v),
                      largest_axis(place->x_u, place->x_v, place->y_u, place->y_v), output_.pixel(x, y - first_row_));
      }
    }
  }

  KernelShape shape_of(int index) const {
    return {static_cast<double>(pixels_.across[index]), static_cast<double>(pixels_.down[index]),
            static_cast<double>(pixels_.shear[index])};
  }

  /// The pixels of kernels that reach this far from these positions, and those
  /// that are read beyond.
  static PixelBox box_around(const TileBounds& b, double reach_in_x, double reach_in_y) {
    const double rx = std::min(reach_in_x, 1e6), ry = std::min(reach_in_y, 1e6);
    return {static_cast<int>(std::floor(static_cast<double>(b.x0) - rx)),
            static_cast<int>(std::floor(static_cast<double>(b.y0) - ry)),
            static_cast<int>(std::ceil(static_cast<double>(b.x1) + rx)) + 1 + kReadBeyond,
            static_cast<int>(std::ceil(static_cast<double>(b.y1) + ry)) + 1};
  }

  /// Where a lat-long's columns close in fast, its kernels widen from row to
  /// row (PixelFilter).
  bool affine(const PixelBox& box) const {
    constexpr int kNearPole = 4;  // kernel heights
    if (!job_.neighbourhood.is_latlong()) return true;
    const int reach = kNearPole * (box.last_y - box.first_y);
    return box.first_y > reach && box.last_y < job_.neighbourhood.pixels().height() - reach;
  }

  /// Whether eight by eight samples do at each of these positions, as far as
  /// their surroundings are concerned.
  bool lies_well(int region, const TileBounds& bounds, double margin) const {
    const double reach = static_cast<double>(InterpolatingKernel::kReach) + margin;
    const PixelBox box = box_around(bounds, reach, reach);
    return job_.neighbourhood.is_plain(region, box) &&
           !job_.contrast.harsh(box.first_x, box.first_y, box.last_x - 1, box.last_y - 1);
  }

  /// Whether a part that is made smaller shows nothing that its pixels could
  /// not: at up to 36 places the fourth difference of the source over half
  /// output pixels, along the axes in which it is made smaller, is below a
  /// hundredth of the mean. A wave of the output's Nyquist frequency makes four
  /// times its amplitude of it, one of a quarter .02 times.
  bool is_smooth(const Part& part) {
    constexpr int kMostPlaces = 6, kPoints = 5;
    constexpr float kLimit = 4 * 0.01f;
    const int places = std::min({kMostPlaces, part.width / 4, part.height / 4});
    if (places < 2) return false;
    int count = 0;
    const auto add_line = [&](int index, double dx, double dy) {
      for (int k = -2; k <= 2; ++k, ++count) {
        places_.x[count] = pixels_.x[index] + static_cast<float>(0.5 * k * dx);
        places_.y[count] = pixels_.y[index] + static_cast<float>(0.5 * k * dy);
      }
    };
    for (int j = 0; j < places; ++j) {
      for (int i = 0; i < places; ++i) {
        const int index = (part.y + (part.height - 2) * j / (places - 1)) * Tile::kSide + part.x +
                          (part.width - 2) * i / (places - 1);
        const auto step = [&](const float* plane, int by) {
          return static_cast<double>(plane[index + by] - plane[index]);
        };
        const double x_u = step(pixels_.x, 1), x_v = step(pixels_.x, Tile::kSide);
        const double y_u = step(pixels_.y, 1), y_v = step(pixels_.y, Tile::kSide);
        const double a = x_u * x_u + x_v * x_v, b = x_u * y_u + x_v * y_v, c = y_u * y_u + y_v * y_v;
        const double angle = 0.5 * std::atan2(2 * b, a - c), mean = 0.5 * (a + c);
        const double spread = std::sqrt(0.25 * (a - c) * (a - c) + b * b);
        const double largest = std::sqrt(mean + spread), least = std::sqrt(std::max(0.0, mean - spread));
        add_line(index, largest * std::cos(angle), largest * std::sin(angle));
        if (least > kHarmlessScale) add_line(index, -least * std::sin(angle), least * std::cos(angle));
      }
    }
    const View<const float> source = job_.neighbourhood.pixels();
    float values[3 * 2 * kMostPlaces * kMostPlaces * kPoints];
    std::fill(place_kinds_, place_kinds_ + count, KernelKind::kInterpolated);
    filter_row(
        {source.data(), source.stride(), &places_, place_kinds_, 0, count, -std::numeric_limits<float>::infinity()},
        values);
    for (int k = 0; k < count; k += kPoints) {
      for (int channel = 0; channel < 3; ++channel) {
        const float* v = values + 3 * k + channel;
        const float difference = v[0] - 4 * v[3] + 6 * v[6] - 4 * v[9] + v[12];
        if (std::abs(difference) > kLimit * std::abs(0.2f * (v[0] + v[3] + v[6] + v[9] + v[12]))) return false;
      }
    }
    return true;
  }

  bool may_interpolate(int region, const Part& part, const TileBounds& bounds) {
    constexpr double kMost = 8;  // beyond it so much is left out that some places say little
    const double scale = static_cast<double>(bounds.scale);
    if (scale <= kHarmlessScale) return lies_well(region, bounds, 0);
    return scale <= kMost && lies_well(region, bounds, scale) && is_smooth(part);
  }

  KernelKind kind_of(int region, int index) const {
    const TileBounds here{pixels_.x[index], pixels_.y[index], pixels_.x[index], pixels_.y[index], pixels_.scale[index]};
    if (static_cast<double>(here.scale) <= kHarmlessScale && lies_well(region, here, 0))
      return KernelKind::kInterpolated;
    const KernelShape shape = shape_of(index);
    const double reach = static_cast<double>(SharpKernel::kReach);
    const PixelBox box = box_around(here, reach_x(shape, reach), reach_y(shape, reach));
    if (!affine(box)) return KernelKind::kNone;
    if (!job_.neighbourhood.is_plain(region, box)) {
      // Close to a ball's rim, which shows some pixels' worth of the scene
      // along thousands, nothing is left to alias.
      const bool rim = job_.neighbourhood.ends_at_rim() && lies_well(region, here, 0);
      return rim ? KernelKind::kInterpolated : KernelKind::kNone;
    }
    const bool harsh = job_.contrast.harsh(box.first_x, box.first_y, box.last_x - 1, box.last_y - 1);
    return harsh ? KernelKind::kTent : KernelKind::kSharp;
  }

  const Shared& job_;
  View<float> output_;
  int first_row_;
  PixelFilter filter_;
  TilePixels pixels_;
  KernelKind kinds_[TilePixels::kCount];
  TilePixels places_;  ///< of is_smooth
  KernelKind place_kinds_[TilePixels::kCount];
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
    for (int y = 0; y < band.height(); ++y) std::fill_n(band.row(y), band.width() * band.channels(), 0.0f);
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
