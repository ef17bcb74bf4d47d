#pragma once
#include "libhdr/merge/merge.h"

namespace hdr::bench {

enum class RowKernel {
  kFast,       ///< what merge() runs
  kEveryTile,  ///< the same, looking at tiles in which a shot has nothing to add, too
  kReference,  ///< reference::merge_row, one sample after the other
};

struct MergedRows {
  Image<float> rgb;
  double skipped_share = 0;  ///< of the tiles of all shots
};

/// The inner loops of merging a registered bracket in memory, rows in parallel, and nothing around them.
MergedRows merged_rows(const Bracket& bracket, const Response& response, WeightKind weight, RowKernel kernel);

}  // namespace hdr::bench
