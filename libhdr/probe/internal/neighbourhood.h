#pragma once
// What lies beside a pixel on the sphere, which is not always what lies beside it in the picture.
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/ball_camera.h"
#include "libhdr/probe/projection.h"

namespace hdr::internal {

/// Pixels first_x <= x < last_x, first_y <= y < last_y.
struct PixelBox {
  int first_x, first_y, last_x, last_y;
};

/// A lat-long wraps at its seam and continues over its poles, a panorama of 360 degrees at its seam, an octahedron over
/// its edges; beyond a cube's face, one of two paraboloids or an angular map's rim its own formula goes on into another
/// place of the picture. A ball's or lens's disc ends: the background beside it is not light that it showed, so pixels
/// that the rim cuts do not count.
class Neighbourhood {
 public:
  Neighbourhood(View<const float> pixels, const Projection& projection);

  View<const float> pixels() const { return pixels_; }
  const Projection& projection() const { return projection_; }

  /// Which part of the picture (a cube's face, one of two discs; else 0) holds a position.
  int region_of(const Vec2& px) const;

  int regions() const { return static_cast<int>(boxes_.size()); }

  /// Whether all pixels of the box are what a kernel centred in the region means by them.
  bool is_plain(int region, const PixelBox& box) const;

  /// The pixels first <= x < last of a row.
  struct Span {
    int first = 0, last = 0;
  };
  /// Those for each of which is_plain() says yes.
  Span plain_in_row(int region, int y) const {
    const auto& rows = spans_[static_cast<std::size_t>(region)];
    return y < 0 || y >= static_cast<int>(rows.size()) ? Span{} : rows[static_cast<std::size_t>(y)];
  }

  /// value[c] = what a kernel centred in the region means by pixel (x, y), which may lie outside of the picture; false:
  /// the picture does not show it.
  bool tap(int region, int x, int y, float* value) const;

  /// Beyond its disc the picture shows nothing.
  bool ends_at_rim() const { return kind_ == Kind::kDisc; }
  bool is_latlong() const { return kind_ == Kind::kLatLong; }

 private:
  enum class Kind { kPlain, kLatLong, kAround, kOctahedral, kContinued, kDisc };

  bool copy(int x, int y, float* value) const;
  bool continued(int region, int x, int y, float* value) const;
  Span span_of(std::size_t region, int y) const;

  View<const float> pixels_;
  Projection projection_;
  Kind kind_;
  std::vector<PixelBox> boxes_;           ///< of the regions
  std::vector<Ellipse> discs_;            ///< of the regions, where they are discs
  std::vector<std::vector<Span>> spans_;  ///< of the regions' rows
};

}  // namespace hdr::internal
