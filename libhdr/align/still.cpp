#include "libhdr/align/internal/still.h"

#include <algorithm>
#include <cmath>

namespace hdr::internal {
namespace {

// Tiles a side of the mosaic: 36 864 pixels of a photograph of any size tell of most that it lies still; where they
// leave a doubt, twice and four times as many a side are asked.
constexpr int kFewestTiles = PhotoSamples::kTiles, kMostTiles = 24, kTileSide = PhotoSamples::kTileSide;
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
    const Vec2 corner(tile_corner(static_cast<int>(index.x()), tiles, photo.width),
                      tile_corner(static_cast<int>(index.y()), tiles, photo.height));
    tile.middle += corner - index * kTileSide;
  }
}

}  // namespace

LogPicture thumbnail(const PhotoSamples& samples, double h, const Linearizer& linearizer, int samples_a_side) {
  const Size size = std::visit([](const auto& codes) { return codes.size(); }, samples.lattice);
  int cell = 1;  // of the lattice
  while (std::max(size.width, size.height) / cell > 191) cell *= 2;
  LogPicture small = log_picture(samples.lattice, h, linearizer, cell, std::max(1, cell / samples_a_side));
  small.cell *= samples.step;
  return small;
}

StillProbe::StillProbe(const Photo& photo, std::shared_ptr<const PhotoSamples> samples, const Linearizer& linearizer)
    : photo_(photo),
      samples_(std::move(samples)),
      linearizer_(&linearizer),
      thumbnail_(internal::thumbnail(*samples_, photo.relative_exposure(), linearizer, kSamplesASide)) {
  if (most_tiles() >= kFewestTiles) tiles(kFewestTiles);
}

int StillProbe::most_tiles() const {
  return std::min(kMostTiles, std::min(size().width, size().height) / kTileSide);
}

const LogPicture& StillProbe::tiles(int count) {
  LogPicture& mosaic = tiles_[count];
  if (!mosaic.ln.empty()) return mosaic;
  const double h = photo_.relative_exposure();
  if (count == PhotoSamples::kTiles) {
    mosaic = tile_picture(samples_->tiles, h, *linearizer_);
  } else {
    if (!whole_) whole_.emplace(photo_);
    mosaic = tile_picture(cut_tiles((*whole_)->codes, count), h, *linearizer_);
  }
  return mosaic = smoothed(mosaic, 2);
}

void StillProbe::forget_whole() {
  whole_.reset();
  std::erase_if(tiles_, [](const auto& mosaic) { return mosaic.first != kFewestTiles; });
}

StillPair::StillPair(StillProbe& a, StillProbe& b) : a_(a), b_(b), tiles_(std::min(kFewestTiles, a.most_tiles())) {
  const std::vector<Vec2> far = search_shifts(a.thumbnail(), b.thumbnail(), kNearRadius, 1);
  elsewhere_ = far.empty() || far[0].cwiseAbs().maxCoeff() > 0.5 * a.thumbnail().cell;
  if (tiles_ < kFewestTiles) answer_.stillness = elsewhere_ ? Stillness::kMoved : Stillness::kUnclear;
}

const StillAnswer& StillPair::ask_few() {
  if (tiles_ == kFewestTiles) ask();
  return answer_;
}

const StillAnswer& StillPair::ask_all() {
  while (answer_.stillness == Stillness::kUnclear && tiles_ < a_.most_tiles()) {
    tiles_ = std::min(2 * tiles_, a_.most_tiles());
    ask();
  }
  return answer_;
}

void StillPair::ask() {
  const MotionFrame frame(a_.size());
  const bool last = tiles_ == a_.most_tiles();
  const LogPicture &from = a_.tiles(tiles_), &to = b_.tiles(tiles_);
  const std::optional<double> agreeing = agreement(from, to, Mat3::Identity());
  if (elsewhere_ && !agreeing.has_value()) {  // nor would more tiles have texture above the noise
    tiles_ = a_.most_tiles();
    return;
  }
  if (elsewhere_ && *agreeing < kLeastInliers) {
    answer_.stillness = Stillness::kMoved;
    return;
  }
  // Noise may hide the texture of single pixels; then the thumbnails have said that both show the same.
  const PairMotion near = refine_in_place(a_.size(), from, to, agreeing.value_or(1),
                                          [&](Linearization& at) { place_tiles(at, a_.size(), tiles_); });
  if (!near.trouble.empty()) return;  // more tiles may have what these lack
  const double moved = frame.farthest_between(near.b_from_a, Mat3::Identity());
  const double doubt = frame.rms(near.covariance());
  if (moved + kSure * doubt < kStillPx || (last && moved < kStillPx)) {
    answer_ = {Stillness::kStill, near};
  } else if (doubt < kStillPx && moved - kMoved * doubt < kStillPx) {
    answer_ = {Stillness::kNearlyStill, near};
  } else if (moved - (tiles_ == kFewestTiles ? kMovedFar : kMoved) * doubt > kStillPx) {
    answer_.stillness = Stillness::kMoved;
  }
}

bool lies_still(double moved_px, double error_px) {
  return moved_px < kStillPx && moved_px < 3 * error_px + kBiasPx;
}

}  // namespace hdr::internal
