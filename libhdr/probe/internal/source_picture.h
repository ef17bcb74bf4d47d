#pragma once
// A picture read bilinearly at continuous pixel positions, with the neighbourhood its projection gives it.
#include <optional>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/neighbourhood.h"
#include "libhdr/probe/projection.h"

namespace hdr::internal {

class SourcePicture {
 public:
  SourcePicture(View<const float> pixels, const Projection& projection);

  int channels() const { return pixels_.channels(); }
  bool contains(const Vec2& px) const {
    return px.x() >= 0 && px.x() <= pixels_.width() && px.y() >= 0 && px.y() <= pixels_.height();
  }

  /// sum[c] += the bilinear value at px, for each channel.
  void add(const Vec2& px, double* sum) const;

  /// b - a in pixels, over a lat-long's seam by the short way.
  Vec2 step(const Vec2& a, const Vec2& b) const;

  /// The length of step(a, b), a lat-long's horizontal part shortened towards the poles as its circles of latitude are.
  double distance(const Vec2& a, const Vec2& b) const;

 private:
  void add_beside_edge(const Vec2& px, double* sum) const;

  View<const float> pixels_;
  Neighbourhood neighbourhood_;
  std::optional<Vec2> middle_;  ///< of a disc
};

}  // namespace hdr::internal
