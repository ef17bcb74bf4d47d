#pragma once
// The rotation on which most of some matched directions agree, whatever the others are [Fischler81].
#include <cstdint>
#include <vector>

#include "libhdr/core/vec.h"

namespace hdr::internal {

/// Unit directions that may be the same one, in the axes of two views; as many of both, one at least.
struct RayPairs {
  std::vector<Vec3> a, b;
};

struct Consensus {
  Mat3 a_from_b = Mat3::Identity();
  double score = 0;  ///< sum over the matches of 1 - (off / allowed)^2, where that is positive
};

/// Two matches make a rotation; the best of 200 is refined by those that agree with it. `allowed`: the chord between
/// rays that still agree.
Consensus consensus(const RayPairs& rays, double allowed, std::uint64_t seed);

/// Those that agree with a rotation.
std::vector<std::size_t> inliers_of(const RayPairs& rays, const Mat3& a_from_b, double allowed);

}  // namespace hdr::internal
