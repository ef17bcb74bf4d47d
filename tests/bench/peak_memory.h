#pragma once
#include <cstdint>

namespace hdr::bench {

/// Most memory of the process since this was made, beyond what was resident then: Linux forgets its high-water mark
/// when asked to (/proc/self/clear_refs). Where it does not, nothing is known, and that is what bytes() says.
class PeakMemory {
 public:
  PeakMemory();
  std::int64_t bytes() const;  ///< below 0: unknown

 private:
  std::int64_t before_ = -1;
};

}  // namespace hdr::bench
