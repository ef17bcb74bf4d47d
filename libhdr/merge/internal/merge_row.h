#pragma once
// The inner loops of the merge: one row of the map from one row of each shot.
#include <array>
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/merge/internal/merge_model.h"

namespace hdr::internal {

/// Rows are merged in tiles of this many pixels.
constexpr int kTile = 64;

/// A row of a shot that had to be resampled, or a part of one: one plane a channel, a whole number of tiles long.
struct WarpedRow {
  explicit WarpedRow(int width = 0);
  void set_outside(std::size_t x);

  std::array<std::vector<float>, 3> level;                 ///< maximum likelihood; negative outside the photograph
  std::array<std::vector<float>, 3> weight, weight_light;  ///< hat, trust included; zero outside
  std::array<std::vector<float>, 3> information;           ///< variance of a pixel's own code over that of this mean
  std::array<std::vector<float>, 3> trust;                 ///< maximum likelihood: how far it is believed, (0, 1]
  std::array<std::vector<std::uint8_t>, 3> closes;         ///< 1: the nearest code closes the sample
};

/// One shot's share in a row.
struct ShotRow {
  const void* codes = nullptr;        ///< RGB interleaved, of 8 or 16 bits as the model says; nullptr: it is warped
  const WarpedRow* warped = nullptr;  ///< else nullptr
  float exposure = 1;                 ///< H in the map's unit
  /// How far each pixel is believed, 0 .. 1, for a whole number of tiles; at 0 it is as if outside. nullptr: all are.
  const float* trust = nullptr;
};

struct TileCount {
  std::int64_t all = 0, skipped = 0;  ///< tiles of shots
};

/// A row to be merged. Shots in rising order of exposure.
struct MergeRowTask {
  const MergeModel* model;
  const ShotRow* shots;
  int count;  ///< of shots
  int width;
  bool skip_tiles = true;  ///< pass over tiles in which a shot has nothing to add
  // Results:
  float* rgb;                ///< 3 width: radiance; 0 where no shot measured it
  float* stddev;             ///< 3 width, or nullptr
  std::uint8_t* unmeasured;  ///< 3 width: 1 where no shot measured it: black, clipped or outside in all
};

/// Scratch memory of a thread for any number of rows.
struct MergeRowScratch {
  std::vector<float> levels;          ///< count x kTile
  std::vector<std::uint16_t> planes;  ///< count x 3 x kTile codes, of either size
};

/// On the best instructions that the machine has. The meaning is that of reference::merge_row, to the bit.
TileCount merge_row(const MergeRowTask& task, MergeRowScratch& scratch);

namespace reference {

/// The obvious version: one sample after the other.
void merge_row(const MergeRowTask& task);

}  // namespace reference

}  // namespace hdr::internal
