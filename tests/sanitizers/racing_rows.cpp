// A race on purpose: who tells the thread sanitizer what oneTBB does (core/parallel.cpp) must not hide what bodies do.
#include <cstdio>

#include "libhdr/core/parallel.h"

int main() {
  int sum = 0;
  hdr::set_threads(2);
  for (int round = 0; round < 200; ++round) {
    hdr::for_rows(64, 1, [&](int first, int) {
      for (int k = 0; k < 1000; ++k) sum += first;  // what a sum over rows without reduce_rows would do
    });
  }
  std::printf("%d\n", sum);
}
