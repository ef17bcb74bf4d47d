#pragma once
// Which pixels get more directions, and how many. A pixel's share is decided by what its neighbours' passes tell, never
// by its own: were it decided by its own, pixels that missed the light by chance would stop early, and the picture
// would be too dark [Tamstorf97]. As it is, how much work a pixel gets says nothing of its errors so far, and its mean
// stays unbiased.
#include <cstdint>
#include <vector>

#include "libhdr/render/internal/film.h"

namespace hdr {

/// Standard deviation of one direction's estimate of a pixel divided by the pixel's luminance, from its neighbours: the
/// root of their mean relative variance. 0 where neither the pixel nor a neighbour shows the scene. Values below a
/// tenth of the picture's mean are measured against that: deep shadows are no place to be precise.
std::vector<float> relative_deviations(const Film& film);

/// Directions of the next passes: `base` times 2^level for pixels of that level, none for level -1.
struct Allotment {
  std::vector<std::int8_t> levels;
  int base = 1;
  int highest = -1;

  int directions(int level) const { return base << level; }
  /// 1 where a pixel does not have this level.
  std::vector<std::uint8_t> others(int level) const;
};

/// Spends `budget` directions (of the whole picture) where they lower the mean of squared relative errors most: in all,
/// a pixel's work is proportional to its deviation.
Allotment allot_budget(const Film& film, const std::vector<float>& deviations, double budget, int base);

/// What each pixel lacks for its relative standard error to be `error`, but no more than four times what it has and no
/// more than `most` in all: early estimates are not to be trusted far.
Allotment allot_to_error(const Film& film, const std::vector<float>& deviations, double error, int base, double most);

}  // namespace hdr
