#pragma once
// The weighted mean of the source over one output pixel's kernel.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/probe/internal/contrast.h"
#include "libhdr/probe/internal/coordinates.h"
#include "libhdr/probe/internal/kernel_shape.h"
#include "libhdr/probe/internal/neighbourhood.h"
#include "libhdr/probe/internal/source_picture.h"
#include "libhdr/probe/internal/spline.h"

namespace hdr::internal {

/// Up to this scale only waves shorter than 3.2 source pixels could come out wrong when they are interpolated, and no
/// lens leaves much of those.
inline constexpr double kHarmlessScale = 1.6;

/// kInterpolated and kSpline are for what is not made smaller, or has nothing that smaller pixels could not show;
/// kSpline where its error is small (spline.h).
enum class KernelKind : std::uint8_t { kNone, kSharp, kTent, kInterpolated, kSpline };

/// One pixel anywhere: at seams, poles, faces' edges and rims; any number of channels.
class PixelFilter {
 public:
  PixelFilter(const Neighbourhood& source, const SourcePicture& bilinear, const Contrast& contrast);

  /// mean[c] for each channel, at a position in the source (continuous pixels).
  /// `scale` is the larger axis of the output pixel's ellipse, which decides whether to interpolate.
  void write(int region, const Vec2& px, const KernelShape& shape, double scale, float* mean);

  /// The same of standard deviations, whose errors are independent from pixel to pixel: the root of the sum of squared
  /// weights times squared deviations.
  void write_deviation(int region, const Vec2& px, const KernelShape& shape, double scale, float* deviation);
  /// Likewise under the kernel that filter_row was told to use.
  void write_deviation(KernelKind kind, int region, const Vec2& px, const KernelShape& shape, float* deviation);

 private:
  struct Sums {
    double weight = 0, whole_weight = 0;
    bool missing = false;  ///< a tap that the picture does not show
  };
  enum class Of { kValues, kDeviations };
  template <Of kOf>
  double add_pixels(const float* pixel, const double* weights, int count, double scale);
  template <Of kOf, class Kernel>
  Sums add(int region, const Vec2& px, const KernelShape& shape);
  template <Of kOf>
  Sums add_chosen(int region, const Vec2& px, const KernelShape& shape, double scale);
  void write_root(const Sums& sums, float* deviation) const;
  PixelBox seen(const Vec2& px, const KernelShape& shape) const;
  bool is_harsh(const PixelBox& box) const;

  const Neighbourhood& source_;
  const SourcePicture& bilinear_;
  const Contrast& contrast_;
  std::vector<double> sum_, weights_;
  std::vector<float> value_;
};

/// The positions and kernels of a tile's pixels, in planes that may be read some floats beyond their end; x and y in
/// pixel numbers (the centre of pixel 0 is 0).
struct TilePixels {
  static constexpr int kCount = Tile::kSide * Tile::kSide;
  alignas(64) float x[kCount], y[kCount], across[kCount], down[kCount], shear[kCount];
  alignas(64) float scale[kCount];  ///< the ellipse's larger axis, source pixels an output pixel
};

/// Around all positions of a tile, and its largest scale.
struct TileBounds {
  float x0, y0, x1, y1, scale;
};

/// Of the first tile.width x tile.height pixels; row k at k * kSide.
TileBounds place_tile(const TilePolynomial& polynomial, const Tile& tile, TilePixels& pixels);

/// Vectors may be read from a kernel's first pixels on, and so this many beyond its last: they must exist.
inline constexpr int kReadBeyond = 1;

/// Of a source for kSharp and kTent: they read eight pixels of a row at a time.
inline constexpr int kLeastFilteredWidth = 8;

/// Filters `count` pixels of one row of a tile, starting at plane index `first`, three channels, from a source of which
/// every pixel under the kernels is plain. Results below `floor` are raised to it.
struct RowTask {
  const float* source;
  int width;  ///< of the source
  std::ptrdiff_t stride;
  const TilePixels* pixels;
  const KernelKind* kinds;  ///< like the planes; kNone: this pixel is not wanted
  int first, count;
  float floor;
  const SplineTile* spline = nullptr;  ///< for kSpline
};
void filter_row(const RowTask& task, float* rgb);

}  // namespace hdr::internal
