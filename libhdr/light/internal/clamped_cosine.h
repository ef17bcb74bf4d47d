#pragma once

namespace hdr {

/// A_l of E_lm = A_l L_lm: the clamped cosine max(n.w, 0) = sum of A_l (2l + 1) / (4 pi) P_l(n.w).
double clamped_cosine_coefficient(int l);

}  // namespace hdr
