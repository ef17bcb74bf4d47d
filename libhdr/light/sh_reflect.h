#pragma once
// Reflection in frequency space [Ramamoorthi02]: a surface whose lobe is round about one direction blurs its light, and
// a blur is a product band by band.
#include <functional>
#include <vector>

#include "libhdr/light/sh.h"

namespace hdr {

/// k_l, l = 0 .. degree, of the blur B(d) = integral of L(w) kernel(d.w) dw, which is B_lm = k_l L_lm: 2 pi times the
/// integral of kernel(t) P_l(t) over -1..1 (Funk and Hecke). kernel(t) may have a kink at t = 0.
std::vector<double> kernel_bands(const std::function<double(double cosine)>& kernel, int degree);

/// The blurred light: each band times its k_l; bands beyond the last k_l are dropped.
Sh convolved(const Sh& light, const std::vector<double>& bands);
Sh convolved(const Sh& light, const std::function<double(double cosine)>& kernel);

/// What a Phong lobe of this exponent (>= 0) around the reflected direction sees: the mean of L weighted by
/// max(cos, 0)^exponent. Bands fall as exp(-l^2 / (2 exponent)): degree 4 sqrt(exponent) holds a thousandth.
Sh phong_reflected(const Sh& light, double exponent);

}  // namespace hdr
