#pragma once
// Which shots are compared, and how: neighbours in exposure order, and those one apart, which close the loops.
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libhdr/align/align.h"
#include "libhdr/align/internal/pair.h"

namespace hdr::internal {

/// a and b are indices into `used`.
struct MeasuredPair {
  int a = 0, b = 0;
  PairMotion motion;
  bool good() const { return motion.trouble.empty(); }
};

/// Motions of neighbours, and where the method measures more than whole pixels of those one apart, among the shots
/// `used`. A few shots in memory at a time.
std::vector<MeasuredPair> measure_pairs(const Bracket& bracket, const std::vector<int>& used,
                                        const Linearizer& linearizer, AlignMethod method);

using SharedSamples = std::shared_ptr<const PhotoSamples>;

/// The cheap question first: motions of neighbours, or nullopt as soon as one pair has moved. `samples`: of all shots;
/// where they leave no doubt, no shot is decoded.
std::optional<std::vector<MeasuredPair>> still_pairs(const Bracket& bracket, std::span<const SharedSamples> samples,
                                                     const std::vector<int>& used, const Linearizer& linearizer);

}  // namespace hdr::internal
