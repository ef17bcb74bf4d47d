#include "libhdr/core/pixel_memory.h"

#include <sys/mman.h>

#include <cstring>
#include <new>

namespace hdr {
namespace {

constexpr std::size_t kLarge = std::size_t{4} << 20;
constexpr std::align_val_t kAlignment{64};

}  // namespace

void* allocate_pixels(std::size_t bytes) {
  if (bytes == 0) return nullptr;
  if (bytes < kLarge) {
    void* pixels = ::operator new[](bytes, kAlignment);
    std::memset(pixels, 0, bytes);
    return pixels;
  }
  void* pixels = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (pixels == MAP_FAILED) throw std::bad_alloc();
  // Not huge pages: making room for them cost merging 24 MP .4 CPU s where the disk cache had filled the memory.
  return pixels;
}

void free_pixels(void* pixels, std::size_t bytes) {
  if (pixels == nullptr) return;
  if (bytes < kLarge) {
    ::operator delete[](pixels, kAlignment);
  } else {
    munmap(pixels, bytes);
  }
}

}  // namespace hdr
