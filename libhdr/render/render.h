#pragma once
// A picture of a scene lit by a probe.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "libhdr/core/radiance.h"
#include "libhdr/light/environment.h"
#include "libhdr/render/prt.h"
#include "libhdr/render/scene.h"

namespace hdr {

/// kMc: cosine-stratified directions, eq. 9 of the lecture with its 1/(N M) and visibility. kImportance: directions
/// from the probe. kMis: both, weighted by the balance heuristic [Veach95]. kSh: irradiance from nine coefficients, no
/// shadows, on diffuse materials; other materials as kMis. kPrt: precomputed transfer, shadows included, of harmonics
/// to degree 4, interpolated between vertices, on diffuse materials; others as kMis. kAuto: kMis. Light reaches a
/// surface straight from the probe; only mirrors show other objects.
enum class RenderMethod { kAuto, kMc, kImportance, kMis, kSh, kPrt };
std::optional<RenderMethod> render_method_from_name(const std::string& name);
const char* name_of(RenderMethod method);

struct RenderOptions {
  RenderMethod method = RenderMethod::kAuto;
  Size size{640, 480};
  int samples = 64;  ///< directions per pixel, shared out over camera rays jittered in the pixel
  std::uint64_t seed = 1;
  /// Of kPrt, one a mesh, which then needs normals. Empty: computed, on the meshes cut finer (tessellated()).
  std::vector<Transfer> transfer = {};
  std::function<void(double done)> progress;  ///< share of the picture, 0..1, from any thread
};

struct Rendering {
  RadianceMap picture;    ///< rgb with the probe as backdrop where alpha is 0; alpha = coverage
  RenderMethod method{};  ///< what kAuto became
  std::int64_t rays = 0;
  double samples_per_pixel = 0;
  /// Rms over fully covered, lit pixels of the standard error of luminance divided by its value, from the spread of the
  /// pixel's independent camera rays. Shadows so deep that no sample met light do not count. One sample a pixel has no
  /// spread: 1, nothing is known.
  double estimated_error = 0;
  std::string skipped;  ///< what was not needed, why, and the bound on the error; empty: nothing was skipped
};

/// No shadow rays are traced where nothing can occlude; same bytes for any thread count. Throws Error when the size or
/// the samples are not positive or the camera looks nowhere.
Rendering render(const Scene& scene, const Environment& light, const RenderOptions& options = {});

}  // namespace hdr
