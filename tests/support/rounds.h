#pragma once
// How often a test tries what it tries with another seed.
#include <cstdint>

namespace hdr::test {

/// All that are wanted; under a sanitizer one, which touches the memory that the others would.
constexpr std::uint64_t rounds(std::uint64_t wanted) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return wanted < 1 ? wanted : 1;
#else
  return wanted;
#endif
}

}  // namespace hdr::test
