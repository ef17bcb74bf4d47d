#include "libhdr/core/error.h"

#include <cstdio>
#include <cstdlib>

namespace hdr {

void assertion_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "hdr: internal error: %s does not hold at %s:%d\n", condition, file, line);
  std::abort();
}

}  // namespace hdr
