#pragma once
// Have the shots moved at all? Answered from a small part of the pixels.
#include <map>

#include "libhdr/align/internal/pair.h"
#include "libhdr/core/rows.h"

namespace hdr::internal {

/// A small picture for a search that needs no start: at most 191 pixels on its longer side, each from this many pixels
/// of the photograph along each side.
LogPicture thumbnail(const Photo& photo, const Linearizer& linearizer, int samples_a_side = 4);
inline constexpr int kSearchRadius = 10;  ///< pixels of the thumbnail: 5 to 10 % of the picture

/// One shot while it is asked whether it moved.
class StillProbe {
 public:
  StillProbe(LoadedShot shot, const Linearizer& linearizer);

  const Photo& photo() const { return *shot_; }
  Size size() const { return shot_->size(); }
  const LogPicture& thumbnail() const { return thumbnail_; }
  /// So many tiles at full resolution along each side of a mosaic; made when they are first asked for.
  const LogPicture& tiles(int count);
  /// How many may be asked for; the picture has no more.
  int most_tiles() const;

 private:
  LoadedShot shot_;
  const Linearizer* linearizer_;
  LogPicture thumbnail_;
  std::map<int, LogPicture> tiles_;
};

enum class Stillness { kStill, kMoved, kUnclear };
struct StillAnswer {
  Stillness stillness = Stillness::kUnclear;
  PairMotion motion;  ///< of a pair that lies still
};

/// A pair lies still where its thumbnails correlate best unmoved and tiles at full resolution measure a motion that is
/// surely less than kStillPx; more tiles are looked at while they leave a doubt. Unclear is what all of them do not
/// tell.
StillAnswer still_motion(StillProbe& a, StillProbe& b);

/// Motion that a merge does not see, anywhere in the picture, pixels.
inline constexpr double kStillPx = 0.1;

/// A motion this small (anywhere in the picture) and this uncertain is no evidence of motion.
bool lies_still(double moved_px, double error_px);

}  // namespace hdr::internal
