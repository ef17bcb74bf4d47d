#include "libhdr/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

#include "libhdr/core/error.h"

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
  const int blocks = (count + grain - 1) / grain;
  tbb::parallel_for(0, blocks, [&](int block) { body(block * grain, std::min(count, (block + 1) * grain)); });
}

}  // namespace hdr
