#pragma once
// The inner loop of the merge: sum of w(Z) exp(g(Z)) / H and sum of w(Z) over the shots, for one row.
#include <array>
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// What a code contributes, radiance first so that one load brings both.
struct Contribution {
  float weighted_radiance = 0;
  float weight = 0;
};
using ContributionTable = std::array<std::vector<Contribution>, 3>;  ///< by channel, then by code

/// Numerators and denominators of one row, interleaved RGB. `open` is 1 until a sample has met its closing code.
struct RowSums {
  explicit RowSums(std::size_t samples) : weighted_radiance(samples), weight(samples), open(samples) {}
  void clear();

  std::vector<float> weighted_radiance, weight, open;
};

/// Adds row y of a registered photograph: no resampling. A sample at or above `closing_code` shuts out the shots that
/// follow: what clips a shot clips every longer one, and a code there that says otherwise is JPEG's smear.
void accumulate_row(const Codes& codes, const ContributionTable& table, int closing_code, int y, RowSums& sums);

/// Adds row y of the reference grid, seen through photo_from_ref: contributions are interpolated bilinearly, so light
/// is mixed with light, and a clipped neighbour has no voice. Pixels outside the photograph add nothing.
void accumulate_warped_row(const Codes& codes, const ContributionTable& table, int closing_code,
                           const Mat3& photo_from_ref, int y, RowSums& sums);

}  // namespace hdr
