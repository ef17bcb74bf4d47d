#pragma once
// Where a tile of output pixels lies in the source: exact at a few points, polynomials between them where that is as
// good.
#include <array>
#include <optional>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/neighbourhood.h"
#include "libhdr/probe/projection.h"

namespace hdr::internal {

/// Output pixels first_x .. first_x + width - 1, likewise down; at most kSide each way.
struct Tile {
  static constexpr int kSide = 32;
  int first_x, first_y, width, height;
};

/// Source x and y over a tile as bicubics of s, t in [-1, 1] across it, relative to (base_x, base_y):
/// x = sum x[j][i] s^i t^j. Rows and columns share all of it: sixteen exact positions, and five to check, for 1024
/// pixels.
struct TilePolynomial {
  int region;  ///< of the source (Neighbourhood)
  int base_x, base_y;
  std::array<std::array<float, 4>, 4> x, y;
};

/// A source position with its derivatives by the output's pixels.
struct Place {
  Vec2 px;
  double x_u = 0, x_v = 0, y_u = 0, y_v = 0;
};

class Coordinates {
 public:
  Coordinates(const Neighbourhood& source, const Projection& to, const Mat3& source_from_probe, Size size);

  /// nullopt where the tile holds a seam, a pole, a face's edge, the rim of a disc, or bends too much: where the
  /// polynomial is off by more than kTolerance source pixels at any of five points.
  std::optional<TilePolynomial> polynomial(const Tile& tile) const;

  /// Whether all of the tile's directions are beyond what a lens sees: then it stays as it is. False where that is not
  /// certain.
  bool shows_nothing(const Tile& tile) const;

  /// A pixel by itself; one that the output's disc or the source shows in part is where its middlemost shown part is.
  std::optional<Place> place(int x, int y) const;

 private:
  static constexpr double kTolerance = 1.0 / 256;

  std::optional<Vec2> exact(const Vec2& output_px) const;
  Vec2 slope(const Vec2& output_px, const Vec2& here, const Vec2& step) const;
  Vec2 short_way(Vec2 step) const;

  const Neighbourhood& source_;
  Projection to_;
  Mat3 source_from_probe_;
  Size size_;
  double lens_reach_ = 10;  ///< radians from +Z of the source, beyond which it shows nothing
};

}  // namespace hdr::internal
