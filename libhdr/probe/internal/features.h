#pragma once
// What can be recognised in another photograph of the same place.
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

struct Features {
  std::vector<Vec2> px;      ///< continuous pixels
  Image<float> descriptors;  ///< a row for each, of unit length
};

/// SIFT [Lowe04], descriptors as [Arandjelovic12] has them, of a photograph of linear light; of a large one, reduced
/// until its longer side is at most 2048 pixels. At most `most`, spread over the picture.
Features photo_features(View<const float> rgb, int most);

struct FeaturePair {
  int a, b;
};

/// Features of two photographs that are each other's most alike, and clearly more so than the next.
std::vector<FeaturePair> match_features(const Features& a, const Features& b);

/// The same among those of `b` within `reach` pixels of where one of `a` is expected; kNowhere: not expected at all.
std::vector<FeaturePair> match_near(const Features& a, const Features& b, const std::vector<Vec2>& expected,
                                    double reach);

}  // namespace hdr::internal
