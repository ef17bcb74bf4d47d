#pragma once
// Have the shots moved at all? Answered from a small part of the pixels.
#include <optional>
#include <vector>

#include "libhdr/align/internal/pair.h"

namespace hdr::internal {

/// A small picture for a search that needs no start: at most 191 pixels on its longer side, each from this many pixels
/// of the photograph along each side.
LogPicture thumbnail(const Photo& photo, const Linearizer& linearizer, int samples_a_side = 4);
inline constexpr int kSearchRadius = 10;  ///< pixels of the thumbnail: 5 to 10 % of the picture

/// The motion of a pair that seems to lie still: its thumbnails correlate best unmoved, and tiles at full resolution
/// measure a small motion. nullopt: it has moved, or this cannot tell.
struct StillProbe {
  Size size;  ///< of the photograph
  LogPicture thumbnail, tiles;
};
StillProbe still_probe(const Photo& photo, const Linearizer& linearizer);
std::optional<PairMotion> still_motion(const StillProbe& a, const StillProbe& b);

/// Motion that a merge does not see, anywhere in the picture, pixels.
inline constexpr double kStillPx = 0.1;

/// A motion this small (anywhere in the picture) and this uncertain is no evidence of motion.
bool lies_still(double moved_px, double error_px);

}  // namespace hdr::internal
