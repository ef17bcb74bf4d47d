#pragma once
// Light of which the truth is known: a map to project and sample, and the sums that the fast ways must agree with.
#include <vector>

#include "libhdr/light/lights.h"
#include "libhdr/light/sh.h"

namespace hdr::bench {

/// A sky with clouds, ground and a sun, in random colours of a pixel each: nothing averages out by symmetry.
Image<float> sky(int width);

/// Reads every sample once, on all threads: what any method must at least do.
float read_once(View<const float> map);

/// Pixel by pixel in double; nothing of the fast way is shared. Y_lm over a cell by three Gauss nodes each way: what
/// that leaves, for cells of 2 pi / 256 and degree 10, is below 1e-9, and falls with the sixth power of their size.
Sh brute_force(View<const float> map, int degree);

double relative_error(const Sh& sh, const Sh& truth);

/// Directions spread evenly over the sphere.
std::vector<Vec3> spiral(int count);

/// The sum over all pixels for each normal.
std::vector<Rgb> irradiance_truth(View<const float> latlong, const std::vector<Vec3>& normals);

/// Root mean square of the difference in luminance, over that of the truth.
double rms_of_luminance(const std::vector<Rgb>& answer, const std::vector<Rgb>& truth);

}  // namespace hdr::bench
