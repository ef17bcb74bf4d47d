#pragma once
// Two parallel verbs, on oneTBB. Blocks of rows are fixed by `grain` alone, and reductions join the blocks in order, so
// results do not depend on the number of threads.
#include <functional>
#include <vector>

#include "libhdr/core/error.h"

namespace hdr {

/// Threads used from now on by for_rows and reduce_rows; 0 means all that the machine has.
void set_threads(int count);
int threads();

/// Calls body(first, last) for blocks of `grain` rows that cover [0, count). An exception in a body is rethrown here.
void for_rows(int count, int grain, const std::function<void(int first, int last)>& body);

/// partial(first, last) for each block, then join(total, part) in the order of the blocks.
template <class T, class Partial, class Join>
T reduce_rows(int count, int grain, T total, const Partial& partial, const Join& join) {
  HDR_ASSERT(grain > 0);
  if (count <= 0) return total;
  const int blocks = (count - 1) / grain + 1;
  std::vector<T> parts(static_cast<std::size_t>(blocks), total);
  for_rows(count, grain,
           [&](int first, int last) { parts[static_cast<std::size_t>(first / grain)] = partial(first, last); });
  for (T& part : parts) join(total, part);
  return total;
}

}  // namespace hdr
