#pragma once
#include <functional>

#include "libhdr/merge/merge.h"

namespace hdr::internal {

/// Where a band of the map goes: row k of each view is row first + k of the map. stddev and flags are empty unless
/// uncertainty was asked for.
struct BandViews {
  View<float> rgb, stddev;
  View<std::uint8_t> flags;
};

/// merge_rows(), with memory from the caller: views(first, last) says where rows first .. last - 1 are to be written,
/// and done(first, last) follows when they are.
MergeSummary merge_bands(const Bracket& bracket, const Alignment& alignment, const Response& response,
                         const MergeOptions& options, const std::function<BandViews(int first, int last)>& views,
                         const std::function<void(int first, int last)>& done);

/// Bands have this many rows, but for the last.
constexpr int kBandHeight = 64;

}  // namespace hdr::internal
