#pragma once
// Have the shots moved at all? Answered from a small part of the pixels.
#include <map>
#include <memory>
#include <optional>

#include "libhdr/align/internal/pair.h"
#include "libhdr/core/rows.h"

namespace hdr::internal {

/// A small picture for a search that needs no start: at most 191 pixels on its longer side, each from this many samples
/// along each side of a photograph of exposure `h`.
LogPicture thumbnail(const PhotoSamples& samples, double h, const Linearizer& linearizer, int samples_a_side = 4);
inline constexpr int kSearchRadius = 10;  ///< pixels of the thumbnail: 5 to 10 % of the picture

/// One shot while it is asked whether it moved. Its samples tell of most; it is decoded when they do not.
class StillProbe {
 public:
  /// `photo` must outlive the probe.
  StillProbe(const Photo& photo, std::shared_ptr<const PhotoSamples> samples, const Linearizer& linearizer);

  const Photo& photo() const { return photo_; }
  Size size() const { return photo_.size(); }
  const LogPicture& thumbnail() const { return thumbnail_; }
  /// So many tiles at full resolution along each side of a mosaic; made when they are first asked for.
  const LogPicture& tiles(int count);
  /// How many may be asked for; the picture has no more.
  int most_tiles() const;

  /// What was decoded, and what was made of it, is not needed any more.
  void forget_whole();

 private:
  const Photo& photo_;
  std::shared_ptr<const PhotoSamples> samples_;
  const Linearizer* linearizer_;
  LogPicture thumbnail_;
  std::optional<LoadedShot> whole_;
  std::map<int, LogPicture> tiles_;
};

enum class Stillness { kStill, kNearlyStill, kMoved, kUnclear };
struct StillAnswer {
  Stillness stillness = Stillness::kUnclear;
  PairMotion motion;  ///< of a pair that lies still or nearly so
};

/// Two shots while they are asked whether one moved against the other. They lie still where their thumbnails correlate
/// best unmoved, and tiles at full resolution measure a motion that is surely less than kStillPx. The thumbnails may be
/// wrong where the steps of dark codes are all the detail there is: tiles whose texture agrees in place overrule them.
/// Nearly still is a pair whose motion is known within kStillPx and not plainly more than that: whether such a bracket
/// stays, all its pairs together tell. Unclear is what the tiles do not tell.
class StillPair {
 public:
  /// The probes must outlive the pair.
  StillPair(StillProbe& a, StillProbe& b);
  /// Of the tiles that the samples have: no shot is decoded.
  const StillAnswer& ask_few();
  /// More and more of them while they leave a doubt, to all there is room for.
  const StillAnswer& ask_all();

 private:
  void ask();

  StillProbe &a_, &b_;
  bool elsewhere_;  ///< where the thumbnails correlate best
  int tiles_;       ///< along each side, that were asked last
  StillAnswer answer_;
};

/// Motion that a merge does not see, anywhere in the picture, pixels.
inline constexpr double kStillPx = 0.1;

/// A motion this small (anywhere in the picture) and this uncertain is no evidence of motion.
bool lies_still(double moved_px, double error_px);

}  // namespace hdr::internal
