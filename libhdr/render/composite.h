#pragma once
// Objects into a photograph, with their shadows on its ground and its light on them: differential rendering
// [Debevec98].
#include <optional>

#include "libhdr/light/environment.h"
#include "libhdr/render/render.h"
#include "libhdr/render/scene.h"

namespace hdr {

/// The scene's meshes whose material is a shadow catcher are the ground that the photograph shows, [Debevec98]'s local
/// scene; the others are the objects. Two renders, with the objects and without. What the photograph shows of the
/// ground becomes
///   b (1 - alpha + g (with / without - 1)),
/// g being the share of ground in the pixel that objects leave: [Debevec98] eq. 1, b + with - without, for a ground
/// whose albedo at each place is the one that makes `without` the photograph. Where both renders are equal, and they
/// are to the bit where objects change nothing, the photograph stays as it is.
struct Differential {
  Rendering with;  ///< picture.rgb: the objects alone; alpha: their coverage
  Image<float>
      remains;  ///< three channels: the factor on the photograph, above 1 where objects throw light on the ground
  Image<float>
      ground_light;  ///< three channels and coverage: the ground without the objects, its radiance times coverage
};

/// Throws what render() throws.
Differential render_differential(const Scene& scene, const Environment& light, const RenderOptions& options);

/// `background` of the rendered size (three channels) with the objects in it; `gain` is what the photograph shows of a
/// radiance of 1 of the probe. The result's alpha is 1, its stddev is empty.
RadianceMap composited(View<const float> background, const Differential& differential, double gain = 1);

/// The objects and their shadows alone, to be laid over a photograph elsewhere: rgb (already multiplied by alpha), and
/// alpha = 1 - the luminance that remains.
RadianceMap cut_out(const Differential& differential);

/// render(), with shadow catchers as ground that the probe itself shows: its backdrop, darkened where objects take its
/// light, and transparent but for that. Scenes without catchers are render()'s.
Rendering render_on_ground(const Scene& scene, const Environment& light, const RenderOptions& options);

/// Albedo of the ground in the photograph: by what factor it is brighter than the same ground with albedo 1 would be
/// under the probe alone [Debevec98] section 6. `ground_light` as in Differential, rendered with albedo `rendered`. The
/// median over all pixels of pure ground; nothing when there are none, or no light on them.
std::optional<Rgbf> ground_albedo(View<const float> background, View<const float> ground_light, const Rgbf& rendered);

}  // namespace hdr
