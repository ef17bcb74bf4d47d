#pragma once
// What the camera sees of the scene itself, without its light.
#include "libhdr/render/render.h"
#include "libhdr/render/scene.h"

namespace hdr {

struct SurfaceLayers {
  Image<float> albedo;  ///< three channels: of the first surface, whatever its lobes; times coverage
  Image<float>
      depth;  ///< one channel: distance from the eye along the ray, its mean over what is covered; 0: nothing is
};

/// Of 16 camera rays a pixel, spread by options.filter. Throws Error when the camera looks nowhere.
SurfaceLayers surface_layers(const Scene& scene, const RenderOptions& options);

}  // namespace hdr
