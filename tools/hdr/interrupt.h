#pragma once
// Ctrl-C as an error: what was begun is undone on the way out (the camera gets its settings back, nothing half-written
// stays), which a killed program cannot do.
#include "libhdr/core/error.h"

namespace hdr::tools {

/// Thrown by Interrupt::check().
class Interrupted : public Error {
 public:
  using Error::Error;
};

/// While one lives, SIGINT and SIGTERM are noted instead of ending the program; a second one ends it. One at a time.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  static bool noted();
  /// Throws Interrupted when a signal came.
  static void check();
};

}  // namespace hdr::tools
