#pragma once
// Which kernel each pixel of a tile gets.
#include <cstdint>

#include "libhdr/probe/internal/contrast.h"
#include "libhdr/probe/internal/coordinates.h"
#include "libhdr/probe/internal/neighbourhood.h"
#include "libhdr/probe/internal/pixel_filter.h"
#include "libhdr/probe/internal/spline.h"

namespace hdr::internal {

/// A tile that is one polynomial, pixel by pixel: where each lies in the source, by which kernel, and the coefficients
/// of those that are interpolated by the spline. Decided for the whole tile where that may be, else for its quarters,
/// in the end for each pixel.
class TileKernels {
 public:
  TileKernels(const Neighbourhood& source, const Contrast& contrast) : source_(source), contrast_(contrast) {}

  /// `vectors`: whether filter_row can be used at all; else all kinds are kNone.
  void choose(const Tile& tile, const TilePolynomial& polynomial, bool vectors);

  const TilePixels& pixels() const { return pixels_; }
  const KernelKind* kinds() const { return kinds_; }
  const SplineTile& spline() const { return spline_; }
  KernelShape shape_of(int index) const {
    return {static_cast<double>(pixels_.across[index]), static_cast<double>(pixels_.down[index]),
            static_cast<double>(pixels_.shear[index])};
  }

 private:
  /// A rectangle of the tile's pixels.
  struct Part {
    int x, y, width, height;
  };

  /// What the tile's spline serves.
  struct SplineUse {
    PixelBox box{};
    std::int64_t pixels = 0;
    void add(const PixelBox& b, int count);
  };

  void choose(int region, const Part& part, const TileBounds& bounds);
  void interpolate(int region, const Part& part, const TileBounds& bounds);
  void prepare_spline(const Tile& tile);
  bool may_interpolate(int region, const Part& part, const TileBounds& bounds);
  bool is_smooth(const Part& part);
  bool lies_well(int region, const TileBounds& bounds, double margin) const;
  bool affine(const PixelBox& box) const;
  KernelKind kind_of(int region, int index) const;
  TileBounds bounds_of(const Part& part) const;

  const Neighbourhood& source_;
  const Contrast& contrast_;
  SplineUse use_;
  SplineTile spline_;
  TilePixels pixels_;
  KernelKind kinds_[TilePixels::kCount];
  TilePixels places_;  ///< of is_smooth
  KernelKind place_kinds_[TilePixels::kCount];
};

}  // namespace hdr::internal
