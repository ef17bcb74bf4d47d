#pragma once
// Directional lights as other programs take them.
#include <string>
#include <vector>

#include "libhdr/light/lights.h"

namespace hdr {

/// USD: a Y-up stage of DistantLights, local +Z towards the light; `intensity` times `color` is the irradiance
/// (normalized), angle 0.53 degrees, the sun's.
std::string usd_of(const std::vector<DirectionalLight>& lights);

/// Radiance: a `light` and a `source` each, 0.53 degrees wide, its radiance such that the irradiance is right. Radiance
/// has Z up: (x, y, z) is written as (x, -z, y). Black lights are left out.
std::string rad_of(const std::vector<DirectionalLight>& lights);

}  // namespace hdr
