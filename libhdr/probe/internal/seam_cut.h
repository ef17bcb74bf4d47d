#pragma once
// Which of several pictures of the sphere shows each direction, so that the seams between them are seen least.
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

/// One picture on a small lat-long that all layers share.
struct SeamLayer {
  Image<float> rgb;    ///< radiance at one scale in all layers
  Image<float> shown;  ///< one channel: 0 where the layer shows nothing
  Image<float> cost;   ///< one channel, 0..1: how little the layer likes to be used there
};

/// Labels by graph cut [Kwatra03]: between neighbours that show different layers the seam costs what the two differ by
/// at both, times its length on the sphere; alpha-expansion [Boykov01] with [Boykov04]'s max-flow. Azimuth goes round.
class SeamCut {
 public:
  explicit SeamCut(const std::vector<SeamLayer>& layers);

  /// How much of a direction (u, v: continuous shares of the lat-long) layer k shows: 1 inside of its part, falling to
  /// 0 over some pixels of the small lat-long around its seams; the layers' shares add up to 1 where any is shown.
  double share(std::size_t k, const Vec2& uv) const;

  /// The layer of a pixel of the small lat-long, -1 where none is shown.
  int label(int x, int y) const { return labels_(x, y); }

 private:
  Image<std::int32_t> labels_;
  std::vector<Image<float>> shares_;
};

}  // namespace hdr::internal
