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
/// from the probe. kStructured: one direction from each stratum of the probe's light [Agarwal03]. kPixels: every pixel
/// of the probe a directional light, by subsets that cover it evenly. kMis: from the probe and from the surface,
/// weighted by the balance heuristic [Veach95]. kCache: what occluders take from the soft part of the probe, computed
/// at few points and interpolated [Ward88]; its compact lights as by kImportance. Other materials as by kMis. kAo: not
/// light but openness, the share of the hemisphere that sees the sky, on every material. kSh: irradiance from nine
/// coefficients, no shadows, on diffuse materials. kPrt: precomputed transfer, shadows included, of harmonics to degree
/// 4, interpolated between vertices, on diffuse materials. Other materials are lit as by kMis, but under kMc from their
/// own lobes and under kImportance from the probe alone. kAuto: kMis. Light reaches a surface straight from the probe;
/// only mirrors show other objects.
enum class RenderMethod { kAuto, kMc, kPixels, kImportance, kStructured, kMis, kCache, kAo, kSh, kShAo, kMeanAo, kPrt };
std::optional<RenderMethod> render_method_from_name(const std::string& name);
const char* name_of(RenderMethod method);

/// How wide a pixel's camera rays are spread: evenly over the pixel, or as [Harris78]'s window of three pixels.
enum class FilmFilter { kBox, kBlackmanHarris };

struct RenderOptions {
  RenderMethod method = RenderMethod::kAuto;
  Size size{640, 480};
  int samples = 64;  ///< directions per pixel, dealt to camera rays jittered in the pixel
  std::uint64_t seed = 1;
  /// Of kPrt, one a mesh, which then needs normals. Empty: computed, on the meshes cut finer (tessellated()).
  std::vector<Transfer> transfer = {};
  std::function<void(double done)> progress = {};  ///< share of the picture, 0..1, from any thread
  FilmFilter filter = FilmFilter::kBox;
  bool backdrop = true;  ///< false: black beside the scene; mirrors show the probe all the same
  /// Above 0: paint until the estimated relative standard error of each pixel is this small, spending nothing on pixels
  /// that are there; `samples` is then the most that a pixel may get.
  double error = 0;
  /// How often light goes from surface to surface before it reaches the one that is seen: diffuse interreflection, of
  /// methods that trace what surfaces receive (reflects_light()). What is met on the way reflects diffusely, with its
  /// colour.
  int bounces = 0;
  /// Above 0: kAo, kShAo and kMeanAo see the sky where none of so many depth maps, from all around, shows something
  /// nearer.
  int depth_maps = 0;
};

/// Methods that RenderOptions::bounces is for.
bool reflects_light(RenderMethod method);

struct Rendering {
  RadianceMap picture;  ///< rgb with the probe as backdrop where alpha is 0; alpha = coverage
  Image<float> normal;  ///< three channels, of the world: mean over the pixel of its surfaces' shading normals
  /// One channel: mean square error of the pixel's luminance, from the spread of its passes, and of kCache from what
  /// its records foretell of each other; 0 where it is not known, after fewer than two passes.
  Image<float> variance;
  /// Of scenes with shadow catchers, else empty: their part of `picture`, three channels, and their share of the pixel,
  /// which alpha leaves out.
  Image<float> ground;
  Image<float> albedo, depth;  ///< where surface_layers() (layers.h) was asked; render() leaves them empty
  RenderMethod method{};       ///< what kAuto became
  std::string method_reason;   ///< why; empty when the method was given
  std::int64_t rays = 0;
  double samples_per_pixel = 0;
  /// Rms over fully covered, lit pixels of the standard error of luminance divided by its value, from the spread of the
  /// pixel's independent passes; of kCache with what interpolation may add, from how well its records foretell each
  /// other. Shadows so deep that no sample met light do not count. One sample a pixel has no spread: 1, nothing is
  /// known.
  double estimated_error = 0;
  std::vector<Vec2f> cache_points;  ///< of kCache: where in the picture its records are
  std::string skipped;  ///< what was not needed, why, and the bound on the error; empty: nothing was skipped
};

/// No shadow rays are traced where nothing can occlude; same bytes for any thread count. Throws Error when the size or
/// the samples are not positive or the camera looks nowhere.
Rendering render(const Scene& scene, const Environment& light, const RenderOptions& options = {});

}  // namespace hdr
