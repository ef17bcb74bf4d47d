#pragma once
// A probe as N directional lights: each stands for a region (stratum) of the sphere and carries all of its light.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// kMedianCut [Debevec05]: the region with the most light is cut into two of equal light, across its longer side.
/// kVarianceCut [Viriyothai09]: the region with the largest variance is cut where the variance of the parts is least.
/// kStructured [Agarwal03]: levels of brightness at multiples of the standard deviation, connected components on the
///   sphere, samples to each by L dw^(1/4), strata by Hochbaum and Shmoys' farthest points.
/// kKolligKeller [Kollig03]: Voronoi cells of equal light, by Lloyd's relaxation.
enum class LightsMethod { kMedianCut, kVarianceCut, kStructured, kKolligKeller };
std::optional<LightsMethod> lights_method_from_name(const std::string& name);

/// Where in its region a light stands. kCentroid: the mean direction of the region's light, as published. kMatched:
/// from there moved a little, no farther than the region is wide, so that all lights together have the irradiance of
/// the map (its bands to 8, above all in luminance). kJittered: drawn at random in the region, uniform in solid angle.
enum class LightPlacement { kCentroid, kMatched, kJittered };
std::optional<LightPlacement> light_placement_from_name(const std::string& name);

struct LightsOptions {
  int count = 64;
  LightsMethod method = LightsMethod::kStructured;
  /// Default: kMatched, but kCentroid for kMedianCut, which is here as everybody knows it.
  std::optional<LightPlacement> placement;
  std::uint64_t seed = 1;  ///< of kJittered
};

struct DirectionalLight {
  Vec3 direction = Vec3::UnitY();  ///< unit, from the scene towards the light
  Rgb irradiance = Rgb::Zero();    ///< integral of L over the region: what a surface that faces it receives
  double solid_angle = 0;          ///< of the region, steradians
};

struct Lights {
  std::vector<DirectionalLight> lights;  ///< brightest first, as shadow rays want them
  Image<std::int32_t> strata;            ///< which light each cell of the sphere belongs to: a lat-long, one channel
};

/// Of a lat-long with three channels, finite and non-negative. The lights' irradiances add up to the integral of L,
/// the solid angles to 4 pi. Fewer lights than asked for where the map has fewer pixels. Maps wider than 1024 are cut
/// on cells of several pixels, whose sums are exact. Throws Error when count is below 1.
Lights make_lights(View<const float> latlong, const LightsOptions& options = {});

/// Every pixel that is not black as a directional light: the lecture's second view of the integral. In the map's order.
std::vector<DirectionalLight> pixel_lights(View<const float> latlong);

/// Irradiance at normal n, nothing in between.
Rgb irradiance(const std::vector<DirectionalLight>& lights, const Vec3& n);

/// How far the irradiance of lights is from the map's: the rms over all normals of the difference, divided by the rms
/// of the map's, in luminance.
double irradiance_rms_error(const std::vector<DirectionalLight>& lights, View<const float> latlong);

}  // namespace hdr
