#include "libhdr/merge/internal/stand_ins.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"

namespace hdr::internal {

void StandIns::advance(int band) {
  for_rows(static_cast<int>(sources_.size()), 1,
           [&](int shot, int) { sources_[static_cast<std::size_t>(shot)]->advance(band); });
}

void StandIns::testify(int x, int y, const std::array<float, 3>& gain, std::array<ChannelEvidence, 3>& evidence,
                       std::array<float, 3>& deviation, std::vector<std::int64_t>& used) const {
  std::array<bool, 3> open{};
  // A shot that is black where another is clipped brackets the light already.
  for (std::size_t c = 0; c < 3; ++c) {
    open[c] = evidence[c].measured < 0 && evidence[c].at_least > 0 && evidence[c].at_most < 0;
  }
  for (std::size_t k = sources_.size(); k-- > 0 && (open[0] || open[1] || open[2]);) {
    const Source& source = *sources_[k];
    std::array<int, 3> codes{};
    if (!source.nearest(x, y, codes)) continue;
    bool spoke = false;
    for (std::size_t c = 0; c < 3; ++c) {
      if (!open[c]) continue;
      const ChannelModel& channel = model_.channel[c];
      ChannelEvidence& e = evidence[c];
      const float unit = gain[c] * channel.saturation / source.exposure();
      if (codes[c] >= model_.clipped_code) {
        spoke = spoke || unit > e.at_least;
        e.at_least = std::max(e.at_least, unit);
        continue;  // a shorter one may know
      }
      open[c] = false;
      const float level = channel.level[static_cast<std::size_t>(codes[c])];
      // It shows the edge of a lamp where the others show the lamp: their bound is the better answer.
      if (level * unit <= e.at_least) continue;
      e.measured = level * unit;
      deviation[c] = unit / std::sqrt(channel.precision.at(level));
      spoke = true;
    }
    used[k] += spoke;
  }
}

}  // namespace hdr::internal
