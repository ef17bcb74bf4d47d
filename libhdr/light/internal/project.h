#pragma once
// The two ways of integrating a map against the basis; sh.h's project() chooses.
#include "libhdr/light/sh.h"

namespace hdr {

/// Row moments: cos and sin of the azimuth integrated over each column, the polar factor over each row.
Sh project_latlong(View<const float> rgb, int degree);

/// From a lat-long's own frame (pole +Y, azimuth from +Z to +X) to the basis's (pole +Z, azimuth from +X to +Y).
Sh world_from_map_frame(const Sh& map_frame);

/// Quadrature in each pixel's cell, cut by the picture's disc where there is one.
Sh project_cells(View<const float> rgb, const Projection& projection, int degree);

inline int sh_count(int degree) {
  return (degree + 1) * (degree + 1);
}

}  // namespace hdr
