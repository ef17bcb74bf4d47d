#include "libhdr/align/internal/still.h"

#include <algorithm>
#include <cmath>

namespace hdr::internal {
namespace {

// Tiles a side of the mosaic: 36 864 pixels of a photograph of any size tell of most that it lies still; where they
// leave a doubt, twice and four times as many a side are asked.
constexpr int kFewestTiles = 3, kMostTiles = 24, kTileSide = 64;
constexpr int kNearRadius = 2;    // pixels of the thumbnail: the tiles tell whether what is there is the same
constexpr int kSamplesASide = 2;  // of each cell of a thumbnail: does it lie where it was, or far away?
constexpr double kBiasPx = 0.03;  // what response, compression and resampling may add to a measured shift
constexpr double kSure = 1.5;     // deviations of a measured motion from the bound under which it is called none
constexpr double kMoved = 3;      // and beyond which there is no use in a closer look;
constexpr double kMovedFar = 10;  // at the first, whose few tiles do not know their own deviation well

/// Tiles of the mosaic know where they were cut from the photograph.
void place_tiles(Linearization& at, Size photo, int tiles) {
  for (TileSums& tile : at.tiles) {
    const Vec2 in_mosaic = tile.middle + Vec2(0.5, 0.5);
    const Vec2 index = (in_mosaic / kTileSide).array().floor();
    const Vec2 corner(std::floor((index.x() + 0.5) / tiles * (photo.width - kTileSide)),
                      std::floor((index.y() + 0.5) / tiles * (photo.height - kTileSide)));
    tile.middle += corner - index * kTileSide;
  }
}

}  // namespace

LogPicture thumbnail(const Photo& photo, const Linearizer& linearizer, int samples_a_side) {
  int cell = 1;
  while (std::max(photo.width(), photo.height()) / cell > 191) cell *= 2;
  return log_picture(photo, linearizer, cell, std::max(1, cell / samples_a_side));
}

StillProbe::StillProbe(LoadedShot shot, const Linearizer& linearizer)
    : shot_(std::move(shot)),
      linearizer_(&linearizer),
      thumbnail_(internal::thumbnail(*shot_, linearizer, kSamplesASide)) {
  if (most_tiles() >= kFewestTiles) tiles(kFewestTiles);
}

int StillProbe::most_tiles() const {
  return std::min(kMostTiles, std::min(size().width, size().height) / kTileSide);
}

const LogPicture& StillProbe::tiles(int count) {
  LogPicture& mosaic = tiles_[count];
  if (mosaic.ln.empty()) mosaic = smoothed(tile_picture(*shot_, *linearizer_, 1, count, kTileSide), 2);
  return mosaic;
}

StillAnswer still_motion(StillProbe& a, StillProbe& b) {
  const std::vector<Vec2> far = search_shifts(a.thumbnail(), b.thumbnail(), kNearRadius, 1);
  if (far.empty() || far[0].cwiseAbs().maxCoeff() > 0.5 * a.thumbnail().cell) return {Stillness::kMoved, {}};
  const MotionFrame frame(a.size());
  const int most = a.most_tiles();
  if (most < kFewestTiles) return {Stillness::kUnclear, {}};
  for (int tiles = kFewestTiles;; tiles = std::min(2 * tiles, most)) {
    const bool last = tiles == most;
    const PairMotion near = refine_in_place(a.size(), a.tiles(tiles), b.tiles(tiles),
                                            [&](Linearization& at) { place_tiles(at, a.size(), tiles); });
    if (near.trouble.empty()) {  // else more tiles may have what these lack
      const double moved = frame.farthest_between(near.b_from_a, Mat3::Identity());
      const double doubt = frame.rms(near.covariance());
      if (moved + kSure * doubt < kStillPx || (last && moved < kStillPx)) return {Stillness::kStill, near};
      const double sure = tiles == kFewestTiles ? kMovedFar : kMoved;
      if (moved - sure * doubt > kStillPx) return {Stillness::kMoved, {}};
    }
    if (last) return {Stillness::kUnclear, {}};
  }
}

bool lies_still(double moved_px, double error_px) {
  return moved_px < kStillPx && moved_px < 3 * error_px + kBiasPx;
}

}  // namespace hdr::internal
