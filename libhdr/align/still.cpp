#include "libhdr/align/internal/still.h"

#include <algorithm>
#include <cmath>

namespace hdr::internal {
namespace {

constexpr int kTiles = 6, kTileSide = 64;  // 147 456 pixels of a photograph of any size
constexpr int kNearRadius = 2;             // pixels of the thumbnail: the tiles tell whether what is there is the same
constexpr int kSamplesASide = 2;           // of each cell of a thumbnail: does it lie where it was, or far away?
constexpr double kBiasPx = 0.03;           // what response, compression and resampling may add to a measured shift

}  // namespace

LogPicture thumbnail(const Photo& photo, const Linearizer& linearizer, int samples_a_side) {
  int cell = 1;
  while (std::max(photo.width(), photo.height()) / cell > 191) cell *= 2;
  return log_picture(photo, linearizer, cell, std::max(1, cell / samples_a_side));
}

StillProbe still_probe(const Photo& photo, const Linearizer& linearizer) {
  StillProbe probe{photo.size(), thumbnail(photo, linearizer, kSamplesASide), {}};
  if (std::min(photo.width(), photo.height()) >= kTileSide) {
    probe.tiles = smoothed(tile_picture(photo, linearizer, 1, kTiles, kTileSide), 2);
  }
  return probe;
}

namespace {

/// Tiles of the mosaic know where they were cut from the photograph.
void place_tiles(Linearization& at, Size photo) {
  for (TileSums& tile : at.tiles) {
    const Vec2 in_mosaic = tile.middle + Vec2(0.5, 0.5);
    const Vec2 index = (in_mosaic / kTileSide).array().floor();
    const Vec2 corner(std::floor((index.x() + 0.5) / kTiles * (photo.width - kTileSide)),
                      std::floor((index.y() + 0.5) / kTiles * (photo.height - kTileSide)));
    tile.middle += corner - index * kTileSide;
  }
}

}  // namespace

std::optional<PairMotion> still_motion(const StillProbe& a, const StillProbe& b) {
  const std::vector<Vec2> far = search_shifts(a.thumbnail, b.thumbnail, kNearRadius, 1);
  if (far.empty() || far[0].cwiseAbs().maxCoeff() > 0.5 * a.thumbnail.cell) return std::nullopt;
  if (a.tiles.ln.empty()) return std::nullopt;
  PairMotion near = refine_in_place(a.size, a.tiles, b.tiles, [&](Linearization& at) { place_tiles(at, a.size); });
  const MotionFrame frame(a.size);
  if (!near.trouble.empty() || frame.farthest_between(near.b_from_a, Mat3::Identity()) >= kStillPx) {
    return std::nullopt;
  }
  return near;
}

bool lies_still(double moved_px, double error_px) {
  return moved_px < kStillPx && moved_px < 3 * error_px + kBiasPx;
}

}  // namespace hdr::internal
