#pragma once
// Whether two photographs show the same where a rotation says that they do. Features see single places: in an arcade
// enough columns of one side match those of the other, and only what stands between them tells.
#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/projection.h"

namespace hdr::internal {

struct Agreement {
  double correlation = 0;
  double share = 0;     ///< of the one photograph that the other shows, too
  double contrast = 0;  ///< standard deviation of detail there, ln, of the photograph that has less
};

/// A photograph's light, made small, as logarithms, without its slow changes.
class PhotoDetail {
 public:
  explicit PhotoDetail(View<const float> rgb);
  /// With another photograph, over what both show. `here`, `there`: the lenses of both, at their full sizes.
  Agreement agreement(const Rectilinear& here, const PhotoDetail& other, const Rectilinear& there,
                      const Mat3& here_from_there) const;

 private:
  double scale_ = 1;  ///< pixels of the photograph in one of the detail's
  Image<float> detail_;
};

}  // namespace hdr::internal
