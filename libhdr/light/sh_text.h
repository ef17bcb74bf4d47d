#pragma once
// Spherical harmonics as other programs take them. All have nine coefficients: missing bands count as 0, higher ones
// are left out. Axes are ours (right-handed, +Y up) unless said otherwise.
#include <string>

#include "libhdr/light/sh.h"

namespace hdr {

/// kC: a header with L_lm of every degree, the irradiance matrices, and a function that evaluates E(n).
/// kThreeJs: the 27 numbers of THREE.LightProbe's SphericalHarmonics3.fromArray: L_lm, r g b of each, our basis and
///   order. three.js turns its backgrounds so that a lat-long's middle looks along +X: rotated(sh, Ry(90)) matches.
/// kFilament: E / pi as a polynomial of the normal, nine float3 for IndirectLight::Builder::irradiance(3, ...):
///   c0 + c1 y + c2 z + c3 x + c4 xy + c5 yz + c6 (3z^2 - 1) + c7 zx + c8 (x^2 - y^2).
/// kUnity: the same polynomial for SphericalHarmonicsL2[channel, k], in Unity's left-handed axes: z changes sign.
enum class ShFormat { kC, kThreeJs, kFilament, kUnity };

std::string text_of(const Sh& sh, ShFormat format);

/// The polynomial's nine coefficients (of kFilament), one Rgb each.
std::array<Rgb, 9> irradiance_polynomial(const Sh& sh);

}  // namespace hdr
