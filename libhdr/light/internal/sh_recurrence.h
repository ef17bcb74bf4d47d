#pragma once
// The recurrence of the fully normalised Legendre functions without their factor sin^m [Sloan13].
#include "libhdr/light/sh.h"

namespace hdr {

/// P_l+1 = a (z P_l - b P_l-1) for functions of unit norm over the sphere, from P_mm, and from one P_mm to the next.
struct ShRecurrence {
  double a[kMaxShDegree + 1][kMaxShDegree + 1], b[kMaxShDegree + 1][kMaxShDegree + 1];  ///< [m][l]
  double diagonal[kMaxShDegree + 1];

  static const ShRecurrence& get();

 private:
  ShRecurrence();
};

}  // namespace hdr
