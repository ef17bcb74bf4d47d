#pragma once
// Memory for pixels: zeroed, aligned, and touched once.
#include <cstddef>

namespace hdr {

/// `bytes` zeros on a boundary of at least 64 bytes; nullptr for none. From 4 MB up they are fresh pages of the system:
/// zero without being written. Throws std::bad_alloc.
void* allocate_pixels(std::size_t bytes);
void free_pixels(void* pixels, std::size_t bytes);

}  // namespace hdr
