#pragma once
#include "libhdr/light/internal/light_cells.h"
#include "libhdr/light/lights.h"

namespace hdr {

/// Moves each light by no more than its reach (radians; how far its region's light is spread) so that all together have
/// the irradiance of the cells, in its bands to 8, above all in luminance, as closely as that allows.
void match_irradiance(const LightCells& cells, const std::vector<double>& reach, std::vector<DirectionalLight>& lights);

}  // namespace hdr
