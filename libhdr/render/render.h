#pragma once
// A picture of a scene lit by a probe.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "libhdr/core/radiance.h"
#include "libhdr/light/environment.h"
#include "libhdr/render/scene.h"

namespace hdr {

/// kMc: cosine-stratified directions, eq. 9 of the lecture with its 1/(N M) and visibility. kImportance: directions from
/// the probe. kMis: both, weighted by the balance heuristic [Veach95]. kSh: irradiance from nine coefficients, no
/// shadows (diffuse only). kAuto: kMis.
enum class RenderMethod { kAuto, kMc, kImportance, kMis, kSh };
std::optional<RenderMethod> render_method_from_name(const std::string& name);
const char* name_of(RenderMethod method);

struct RenderOptions {
  RenderMethod method = RenderMethod::kAuto;
  Size size{640, 480};
  int samples = 64;  ///< per pixel
  std::uint64_t seed = 1;
  std::function<void(double done)> progress;  ///< share of the picture, 0..1, from any thread
};

struct Rendering {
  RadianceMap picture;             ///< rgb with the probe as backdrop where alpha is 0; alpha = coverage
  RenderMethod method{};           ///< what kAuto became
  std::int64_t rays = 0;
  double samples_per_pixel = 0;
  double estimated_error = 0;      ///< rms over covered pixels of standard error / value, from the samples themselves
};

/// Unshadowed rays are not traced where nothing can occlude; same bytes for any thread count.
Rendering render(const Scene& scene, const Environment& light, const RenderOptions& options = {});

}  // namespace hdr
