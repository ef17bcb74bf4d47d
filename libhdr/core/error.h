#pragma once
// Four kinds of trouble, four answers:
//   our own bug          -> HDR_ASSERT, which aborts with the place
//   the world's trouble  -> throw hdr::Error("shots/3.jpg: no exposure time in EXIF; pass --times")
//   normally absent      -> std::optional
//   numerical quality    -> a result struct that carries its doubt (Calibration, Alignment, ...)
#include <stdexcept>
#include <string>

namespace hdr {

/// What the person holding the camera can mend: one line, "file: fact; remedy".
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

[[noreturn]] void assertion_failed(const char* condition, const char* file, int line);

}  // namespace hdr

#define HDR_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::hdr::assertion_failed(#condition, __FILE__, __LINE__))
