#include "libhdr/probe/internal/tile_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libhdr/probe/internal/kernel.h"

namespace hdr::internal {
namespace {

constexpr int kSmallestPart = 8;

template <class Part, class Body>
void for_quarters(const Part& part, Body body) {
  const int w = (part.width + 1) / 2, h = (part.height + 1) / 2;
  for (int y = 0; y < part.height; y += h) {
    for (int x = 0; x < part.width; x += w) {
      body(Part{part.x + x, part.y + y, std::min(w, part.width - x), std::min(h, part.height - y)});
    }
  }
}

/// The coefficients that positions within the bounds use.
PixelBox spline_box(const TileBounds& b) {
  return {static_cast<int>(std::floor(b.x0)) - 1, static_cast<int>(std::floor(b.y0)) - 1,
          static_cast<int>(std::floor(b.x1)) + 3, static_cast<int>(std::floor(b.y1)) + 3};
}

/// The pixels of kernels that reach this far from these positions, and those
/// that are read beyond.
PixelBox box_around(const TileBounds& b, double reach_in_x, double reach_in_y) {
  const double rx = std::min(reach_in_x, 1e6), ry = std::min(reach_in_y, 1e6);
  return {static_cast<int>(std::floor(static_cast<double>(b.x0) - rx)),
          static_cast<int>(std::floor(static_cast<double>(b.y0) - ry)),
          static_cast<int>(std::ceil(static_cast<double>(b.x1) + rx)) + 1 + kReadBeyond,
          static_cast<int>(std::ceil(static_cast<double>(b.y1) + ry)) + 1};
}

}  // namespace

void TileKernels::SplineUse::add(const PixelBox& b, int count) {
  box = pixels == 0 ? b
                    : PixelBox{std::min(box.first_x, b.first_x), std::min(box.first_y, b.first_y),
                               std::max(box.last_x, b.last_x), std::max(box.last_y, b.last_y)};
  pixels += count;
}

void TileKernels::choose(const Tile& tile, const TilePolynomial& polynomial, bool vectors) {
  const TileBounds bounds = place_tile(polynomial, tile, pixels_);
  if (!vectors) {
    std::fill_n(kinds_, TilePixels::kCount, KernelKind::kNone);
    return;
  }
  use_ = {};
  choose(polynomial.region, {0, 0, tile.width, tile.height}, bounds);
  prepare_spline(tile);
}

/// For all of a part where that may be, else for its quarters, in the end for
/// each pixel.
void TileKernels::choose(int region, const Part& part, const TileBounds& bounds) {
  if (may_interpolate(region, part, bounds)) return interpolate(region, part, bounds);
  if (std::max(part.width, part.height) > kSmallestPart) {
    for_quarters(part, [&](const Part& quarter) { choose(region, quarter, bounds_of(quarter)); });
    return;
  }
  for (int y = part.y; y < part.y + part.height; ++y) {
    for (int x = part.x; x < part.x + part.width; ++x) {
      const int index = y * Tile::kSide + x;
      kinds_[index] = kind_of(region, index);
    }
  }
}

/// By the spline where it fits.
void TileKernels::interpolate(int region, const Part& part, const TileBounds& bounds) {
  const PixelBox taps = spline_box(bounds);
  const PixelBox all{taps.first_x - SplineTile::kFilterReach, taps.first_y - SplineTile::kFilterReach,
                     taps.last_x + SplineTile::kFilterReach, taps.last_y + SplineTile::kFilterReach};
  const View<const float> source = source_.pixels();
  const bool fits = source_.is_plain(region, all) &&
                    !contrast_.harsh(all.first_x, all.first_y, all.last_x - 1, all.last_y - 1) &&
                    fits_spline(source.data(), source.stride(), taps);
  if (!fits && std::max(part.width, part.height) > kSmallestPart) {
    for_quarters(part, [&](const Part& quarter) { interpolate(region, quarter, bounds_of(quarter)); });
    return;
  }
  if (fits) use_.add(taps, part.width * part.height);
  for (int y = part.y; y < part.y + part.height; ++y) {
    std::fill_n(kinds_ + y * Tile::kSide + part.x, part.width, fits ? KernelKind::kSpline : KernelKind::kInterpolated);
  }
}

/// Where many coefficients would serve few pixels, sixty-four samples each cost less.
void TileKernels::prepare_spline(const Tile& tile) {
  constexpr std::int64_t kMostCoefficients = 6;  ///< a pixel
  if (use_.pixels == 0) return;
  const PixelBox& b = use_.box;
  if (std::int64_t{b.last_x - b.first_x} * (b.last_y - b.first_y) <= kMostCoefficients * use_.pixels) {
    const View<const float> source = source_.pixels();
    return spline_.fill(source.data(), source.stride(), b);
  }
  for (int row = 0; row < tile.height; ++row) {
    KernelKind* kinds = kinds_ + row * Tile::kSide;
    std::replace(kinds, kinds + tile.width, KernelKind::kSpline, KernelKind::kInterpolated);
  }
}

TileBounds TileKernels::bounds_of(const Part& part) const {
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
/// Where a lat-long's columns close in fast, its kernels widen from row to
/// row (PixelFilter).
bool TileKernels::affine(const PixelBox& box) const {
  constexpr int kNearPole = 4;  // kernel heights
  if (!source_.is_latlong()) return true;
  const int reach = kNearPole * (box.last_y - box.first_y);
  return box.first_y > reach && box.last_y < source_.pixels().height() - reach;
}

/// Whether eight by eight samples do at each of these positions, as far as
/// their surroundings are concerned.
bool TileKernels::lies_well(int region, const TileBounds& bounds, double margin) const {
  const double reach = static_cast<double>(InterpolatingKernel::kReach) + margin;
  const PixelBox box = box_around(bounds, reach, reach);
  return source_.is_plain(region, box) && !contrast_.harsh(box.first_x, box.first_y, box.last_x - 1, box.last_y - 1);
}

/// Whether a part that is made smaller shows nothing that its pixels could
/// not: at up to 36 places the fourth difference of the source over half
/// output pixels, along the axes in which it is made smaller, is below a
/// hundredth of the mean. A wave of the output's Nyquist frequency makes four
/// times its amplitude of it, one of a quarter .02 times.
bool TileKernels::is_smooth(const Part& part) {
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
      const int index =
          (part.y + (part.height - 2) * j / (places - 1)) * Tile::kSide + part.x + (part.width - 2) * i / (places - 1);
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
  const View<const float> source = source_.pixels();
  float values[3 * 2 * kMostPlaces * kMostPlaces * kPoints];
  std::fill(place_kinds_, place_kinds_ + count, KernelKind::kInterpolated);
  filter_row({source.data(), source.width(), source.stride(), &places_, place_kinds_, 0, count,
              -std::numeric_limits<float>::infinity()},
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

bool TileKernels::may_interpolate(int region, const Part& part, const TileBounds& bounds) {
  constexpr double kMost = 8;  // beyond it so much is left out that some places say little
  const double scale = static_cast<double>(bounds.scale);
  if (scale <= kHarmlessScale) return lies_well(region, bounds, 0);
  return scale <= kMost && lies_well(region, bounds, scale) && is_smooth(part);
}

KernelKind TileKernels::kind_of(int region, int index) const {
  const TileBounds here{pixels_.x[index], pixels_.y[index], pixels_.x[index], pixels_.y[index], pixels_.scale[index]};
  if (static_cast<double>(here.scale) <= kHarmlessScale && lies_well(region, here, 0)) return KernelKind::kInterpolated;
  const KernelShape shape = shape_of(index);
  const double reach = static_cast<double>(SharpKernel::kReach);
  const PixelBox box = box_around(here, reach_x(shape, reach), reach_y(shape, reach));
  if (!affine(box) || source_.pixels().width() < kLeastFilteredWidth) return KernelKind::kNone;
  if (!source_.is_plain(region, box)) {
    // Close to a ball's rim, which shows some pixels' worth of the scene
    // along thousands, nothing is left to alias.
    const bool rim = source_.ends_at_rim() && lies_well(region, here, 0);
    return rim ? KernelKind::kInterpolated : KernelKind::kNone;
  }
  const bool harsh = contrast_.harsh(box.first_x, box.first_y, box.last_x - 1, box.last_y - 1);
  return harsh ? KernelKind::kTent : KernelKind::kSharp;
}

}  // namespace hdr::internal
