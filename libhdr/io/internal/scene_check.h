#pragma once
// Do the shots of a bracket show one scene? Without a response: whatever the curve and the exposures, a channel's codes
// rise with one another wherever neither shot is black or clipped, so ranks of registered pixels agree [Spearman04].
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/photo_samples.h"

namespace hdr::internal {

/// A small picture of the green codes, at most 64 cells on its longer side.
struct SceneThumbnail {
  Size size;
  std::vector<float> code;  ///< mean of a cell, of 255; below 0 where a sample of it is close to black or clipped
  std::vector<float> rank;  ///< of the usable cells among themselves, -1 .. 1
};

/// Of a photograph whose codes run to `max_code`.
SceneThumbnail thumbnail_of(const PhotoSamples& samples, int max_code);

/// How two thumbnails of one size agree under the best of the shifts that a hand makes.
struct SceneAgreement {
  int cells = 0;           ///< usable in both
  double correlation = 0;  ///< of ranks
  double residual = 0;     ///< median distance from one rising curve, codes of 255
};
SceneAgreement scene_agreement(const SceneThumbnail& a, const SceneThumbnail& b);

/// `shots` rise in exposure; thumbnails[i] belongs to shots[i]. Names a shot of another scene, and one that it differs
/// from. Things that move, hands that shake and flat scenes pass: only a shot that contradicts each of its neighbours
/// that show what most shots show is a stranger.
std::optional<std::string> stranger_among(const std::vector<Photo>& shots, std::span<const SceneThumbnail> thumbnails);

}  // namespace hdr::internal
