#pragma once
// Blurs of linear light, any number of channels. A blur moves light and loses none: that is what tells HDR from LDR
// pictures, in which the sun has been cut down to white before.
#include "libhdr/core/image.h"

namespace hdr {

/// What lies beyond the borders. kPlane: the picture mirrored at its border (border pixels twice), so no light is lost
/// (but for a slanted motion, whose mirror image slants the other way: some, within its length of a border). kLatLong:
/// the sphere; left and right borders meet, and beyond a pole lies the opposite meridian.
enum class Surface { kPlane, kLatLong };

/// Convolution with a Gaussian of `sigma` pixels, >= 0; 0 is a copy. The cost of a pixel does not depend on sigma.
///
/// kPlane: sampled at pixel centres, cut at 6 sigma. From sigma 4 on, as a product of three narrower Gaussians on a
/// grid as coarse as the middle one allows (after [Burt83]); all weights are positive, so the error is relative to what
/// is there and not to the brightest light: below 1e-4. kLatLong: the Gaussian of the sphere, exp((cos angle - 1)/s^2)
/// (von Mises-Fisher), with the solid angles of the pixels [Fisher53]; sigma counts pixels at the equator, s = sigma 2
/// pi / W radians. The same blur at the poles as anywhere. Throws Error: a sigma that is negative or not finite.
Image<float> gaussian_blur(View<const float> image, double sigma, Surface surface = Surface::kPlane);

/// The mean along a straight line of `length` pixels centred on each pixel, `degrees` counter-clockwise from the right
/// (y up): each pixel on the way counts by the length of the line in it, exactly; lengths need not be whole. On a
/// lat-long the line is straight in the picture: at 0 degrees it turns about the vertical. Throws Error: a length that
/// is negative, not finite or beyond 20000.
Image<float> motion_blur(View<const float> image, double length, double degrees, Surface surface = Surface::kPlane);

}  // namespace hdr
