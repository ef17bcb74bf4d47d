#pragma once
// Shots that are not registered well enough to be averaged, but shorter than those that are: what clips in all of these
// has no other measure.
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "libhdr/merge/internal/bounds.h"
#include "libhdr/merge/internal/source.h"

namespace hdr::internal {

class StandIns {
 public:
  /// In rising order of exposure. `model` must outlive it.
  StandIns(const MergeModel& model, std::vector<std::unique_ptr<Source>> sources)
      : model_(model), sources_(std::move(sources)) {}

  std::size_t count() const { return sources_.size(); }
  void advance(int band);
  const Source& source(std::size_t k) const { return *sources_[k]; }

  /// What they say of a pixel of which the registered shots only say "at least": the longest that is not clipped itself
  /// measures a channel, where it does not contradict them; those that are raise the bound. `deviation` of the channels
  /// that became measured; `used`, one for each of the shots, counts up.
  void testify(int x, int y, const std::array<float, 3>& gain, std::array<ChannelEvidence, 3>& evidence,
               std::array<float, 3>& deviation, std::vector<std::int64_t>& used) const;

 private:
  const MergeModel& model_;
  std::vector<std::unique_ptr<Source>> sources_;
};

}  // namespace hdr::internal
