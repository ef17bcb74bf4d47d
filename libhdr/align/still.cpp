#include "libhdr/align/internal/still.h"

#include <algorithm>

namespace hdr::internal {
namespace {

constexpr int kTiles = 8, kTileSide = 64;  // 262 144 pixels of a photograph of any size
constexpr int kSamplesASide = 4;           // of each cell of a thumbnail
constexpr double kStillPx = 0.1;           // a merge does not see it
constexpr double kBracketStillPx = 0.3;    // nor does it gain, if no shot is farther off: resampling would blur as much
constexpr double kBiasPx = 0.03;           // what response, compression and resampling may add to a measured shift

}  // namespace

LogPicture thumbnail(const Photo& photo, const Linearizer& linearizer) {
  int cell = 1;
  while (std::max(photo.width(), photo.height()) / cell > 191) cell *= 2;
  return log_picture(photo, linearizer, cell, std::max(1, cell / kSamplesASide));
}

StillProbe still_probe(const Photo& photo, const Linearizer& linearizer) {
  StillProbe probe{thumbnail(photo, linearizer), {}};
  if (std::min(photo.width(), photo.height()) >= kTileSide) {
    probe.tiles = smoothed(tile_picture(photo, linearizer, 1, kTiles, kTileSide), 2);
  }
  return probe;
}

std::optional<PairMotion> still_motion(const StillProbe& a, const StillProbe& b) {
  const std::vector<Vec2> far = search_shifts(a.thumbnail, b.thumbnail, kSearchRadius, 1);
  if (far.empty() || far[0].cwiseAbs().maxCoeff() > 0.5 * a.thumbnail.cell) return std::nullopt;
  const Vec2 unmoved = Vec2::Zero();
  const PairMotion near = refine_shift({&a.tiles, 1}, {&b.tiles, 1}, {&unmoved, 1});
  if (!near.trouble.empty() || !bracket_lies_still(near.b_from_a.norm())) return std::nullopt;
  return near;
}

bool lies_still(const Vec2& shift, double error_px) {
  return shift.norm() < kStillPx && shift.norm() < 3 * error_px + kBiasPx;
}

bool bracket_lies_still(double farthest_px) {
  return farthest_px < kBracketStillPx;
}

}  // namespace hdr::internal
