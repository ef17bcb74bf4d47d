#pragma once
// A mirror ball is not a perfect mirror: chrome gives back 0.5 to 0.65 of the light it meets head-on, and ever more
// towards the rim.
#include "libhdr/core/radiance.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/projection.h"

namespace hdr {

/// Share of light that a metal reflects: F0 + (1 - F0) (1 - cos)^5 [Schlick94], F0 for each channel at normal
/// incidence.
inline Rgb schlick_reflectance(const Rgb& normal_incidence, double cosine) {
  const double m = 1 - cosine, m2 = m * m;
  return normal_incidence + (1 - normal_incidence) * (m2 * m2 * m);
}

/// The mean of that over the part of pixel (x, y) that the ball covers; 1 where it covers nothing.
Rgb pixel_reflectance(const MirrorBall& ball, int x, int y, const Rgb& normal_incidence);

/// Error that names --reflectance for shares outside (0, 1].
void require_reflectance(const Rgb& normal_incidence);

/// Divides the picture of the ball (and its deviation) by the ball's reflectance: the light that came to it. Error for
/// reflectances outside (0, 1].
void divide_by_reflectance(RadianceMap& picture, const MirrorBall& ball, const Rgb& normal_incidence);

}  // namespace hdr
