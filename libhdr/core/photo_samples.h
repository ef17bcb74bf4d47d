#pragma once
// A small part of a photograph's codes, from which questions about all of it are answered without its pixels at hand:
// how is it exposed, does it show the scene that others show, has it moved against them?
#include <memory>

#include "libhdr/core/photo.h"
#include "libhdr/core/rows.h"

namespace hdr {

struct PhotoSamples {
  Size photo;    ///< the size of the whole
  int step = 1;  ///< a power of two: pixels of the photograph from one pixel of the lattice to the next
  /// RGB, as in Photo: pixel (x, y) is the photograph's (step x + step / 2, step y + step / 2). At least 2^16 pixels of
  /// a photograph that has so many and is not narrower than the step, and less than four times that.
  Codes lattice;
  /// kTiles x kTiles windows of kTileSide pixels a side at full resolution, set side by side; window k of n along a
  /// side begins at tile_corner(k, n, side of the photograph). Empty: the photograph is too small for them.
  Codes tiles;

  static constexpr int kTiles = 3, kTileSide = 64;
};

/// Where window k of n along a side of `length` pixels begins: at (k + 1/2) / n of the range that keeps it inside.
int tile_corner(int k, int n, int length);

/// Windows as in PhotoSamples::tiles, `tiles` along each side, of a photograph that is in memory.
Codes cut_tiles(const Codes& photo, int tiles);

/// Of photographs with so many bits. The rows are read once, to the last: what is damaged is found out.
PhotoSamples sample_rows(PhotoRows& rows, int bits);

/// Those that the photograph keeps; or else taken now from its codes, or from its rows.
std::shared_ptr<const PhotoSamples> samples_of(const Photo& photo);

}  // namespace hdr
