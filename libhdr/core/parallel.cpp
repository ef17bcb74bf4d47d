#include "libhdr/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

#include "libhdr/core/error.h"

// Debian's oneTBB is not built for the thread sanitizer, which then does not see that work starts after for_rows is
// called and ends before it returns. These two calls tell it; a race between the bodies themselves is still one. This
// file alone is not watched: oneTBB's headers share what only oneTBB's library hands over.
#ifdef HDR_TELL_TSAN
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#else
static void __tsan_acquire(void*) {}
static void __tsan_release(void*) {}
#endif

namespace hdr {
namespace {

std::unique_ptr<tbb::global_control>& limit() {
  static std::unique_ptr<tbb::global_control> control;
  return control;
}

}  // namespace

void set_threads(int count) {
  HDR_ASSERT(count >= 0);
  limit().reset();
  if (count > 0) {
    limit() = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<std::size_t>(count));
  }
}

int threads() {
  return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void for_rows(int count, int grain, const std::function<void(int, int)>& body) {
  HDR_ASSERT(grain > 0);
  if (count <= 0) return;
  const int blocks = (count - 1) / grain + 1;
  char started = 0, finished = 0;
  __tsan_release(&started);
  tbb::parallel_for(0, blocks, [&](int block) {
    __tsan_acquire(&started);
    const int first = block * grain;
    body(first, count - first > grain ? first + grain : count);
    __tsan_release(&finished);
  });
  __tsan_acquire(&finished);
}

}  // namespace hdr
