#pragma once
// Which photographs show a part of the same, and roughly how they are turned against each other.
#include <algorithm>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/features.h"
#include "libhdr/probe/projection.h"

namespace hdr::internal {

/// A lens that all photographs were taken with, whatever their size and whichever way up: its focal length in units of
/// a picture's longer side, and k1, k2 of [Brown66].
struct SharedLens {
  double focal = 0.7, k1 = 0, k2 = 0;
};

inline double longer_side(Size size) {
  return std::max(size.width, size.height);
}

/// The lens on a photograph of this size.
Rectilinear camera_of(const SharedLens& lens, Size size);

struct PhotoLink {
  int a, b;                          ///< photographs
  std::vector<FeaturePair> matches;  ///< all; after link_photos() those that agree with the rotation
  Mat3 a_from_b = Mat3::Identity();
  bool verified = false;
  double agreement = 0;  ///< correlation of what both show, once it was looked at (photo_agreement.h)
};

/// By which links are preferred to each other.
double strength_of(const PhotoLink& link);

struct FocalRange {
  double least, most;
};
/// Of a lens of which nothing is known: fields of 20 to 135 degrees over the longer side.
inline constexpr FocalRange kAnyFocal{0.207, 2.84};

/// For each focal length of the range the rotations under which most matches of the pairs agree (two matches make one,
/// by consensus [Fischler81]); the focal length is kept under which most do. Then pairs are verified: of the matches in
/// the part that both show, n, at least 8 + 0.3 n must agree [Brown07] eq. 13. Returns the focal length.
double link_photos(const std::vector<Size>& sizes, const std::vector<Features>& features, FocalRange range,
                   std::vector<PhotoLink>& links);

/// The photographs of the largest group that verified links connect, in rising order, and rotations of all of them
/// along the strongest links, by matches and agreement (first_from_photo; the others stay the identity). Links that
/// contradict those are no longer verified.
struct LinkedGroup {
  std::vector<int> members;
  std::vector<Mat3> first_from_photo;
  std::vector<std::size_t> tree;  ///< the links along which all groups grew
};
LinkedGroup largest_group(int photos, std::vector<PhotoLink>& links);

/// Of the links of a tree between two photographs the weakest.
std::size_t weakest_between(int a, int b, const std::vector<std::size_t>& tree, const std::vector<PhotoLink>& links);

/// Bundle adjustment: rotations (probe_from_photo, of which `fixed` stays), and the shared lens. `focal_deviation`: of
/// the natural logarithm of the focal length, how well it is known; `reach`: how far off matches may be at first, as a
/// share of the longer side. Returns for each match of each link how far it is off, in pixels of the photographs (the
/// mean of both).
struct Bundle {
  std::vector<Mat3> probe_from_photo;
  SharedLens lens;
  double expected_focal = 0, focal_deviation = 0;
  int fixed = 0;
};
struct BundleFit {
  std::vector<std::vector<double>> off_px;
  double median_off = 0;  ///< of all, as a share of the longer side
  double cost = 0;        ///< robust sum of squares, in the same units
  int matches = 0;
};
BundleFit adjust(const std::vector<Size>& sizes, const std::vector<Features>& features,
                 const std::vector<PhotoLink>& links, bool distortion, double reach, Bundle& bundle);

}  // namespace hdr::internal
