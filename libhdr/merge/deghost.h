#pragma once
// Things that moved between the shots: where, and which shots show what the map shows there.
//
// Shots are compared in cells of a few pixels, neighbours in exposure with each other, against the noise model and what
// registration and response leave wrong [Granados13]. Cells that disagree, strongly somewhere and traceably around it
// [Canny86], join to regions. In each region one shot is the reference: the one whose largest set of shots that agree
// with it, one after the other by distance in exposure, measures the region best, clipped and black cells counting for
// nothing [Gallo09]. Another shot is left out where it disagrees with the reference or with one that agrees, or shows
// another texture than these, as a whole piece, and fades out over the cells around it, where all agree. Elsewhere not
// a byte of the map changes.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"

namespace hdr {

struct GhostRegion {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  ///< box of pixels, x1 and y1 beyond it
  std::int64_t pixels = 0;             ///< in which a shot is left out or fades
  int reference = 0;                   ///< index into Bracket::shots
  std::vector<int> left_out;           ///< shots that are, somewhere in the region
};

struct Ghosts {
  double share = 0;  ///< of the map's pixels in which a shot is left out or fades
  std::vector<GhostRegion> regions;
  /// 255 where a shot is left out, less where it fades, 0 elsewhere; of the map's size, 1 channel. Empty without
  /// regions.
  Image<std::uint8_t> mask;
};

}  // namespace hdr
