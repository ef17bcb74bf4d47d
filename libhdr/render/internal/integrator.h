#pragma once
// One way of gathering the light that reaches surfaces: a file each in integrators/.
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libhdr/light/environment.h"
#include "libhdr/render/internal/surfaces.h"
#include "libhdr/render/render.h"

namespace hdr {

/// The picture is painted in passes whose estimates are independent: their spread tells the error.
struct Pass {
  int index = 0;
  int directions = 1;   ///< for each pixel, dealt to its camera rays in turn
  int camera_rays = 1;  ///< of each pixel; not more than directions
  std::uint64_t seed = 1;
  int first_camera_ray = 0;     ///< how many each pixel may have had before
  bool rows_by_chance = false;  ///< each direction stands for all, and not for its part of them

  /// Which camera ray has direction k; over the passes, each has each.
  int camera_ray_of(int k) const { return (k + index) % camera_rays; }
};

/// What an integrator works with; all of it outlives the integrator.
struct Setting {
  const Scene& scene;
  const Tracer& tracer;
  const Environment& light;
  const RenderOptions& options;
  bool convex;        ///< of the scene: what leaves a front meets nothing
  int sh_degree = 2;  ///< of kSh
};

class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Before the tiles of a pass, from one thread: draws what they share.
  virtual void begin(const Pass& pass) = 0;

  /// How many rays that took.
  virtual std::int64_t shared_rays() const { return 0; }

  /// Adds to `out`, at each diffuse surface, an estimate of what its pixel's mean irradiance is: the camera rays of a
  /// pixel share the pass's directions, so only their mean has its meaning. Adds the rays traced to `rays`. From any
  /// thread.
  virtual void irradiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t& rays) const = 0;

  /// Irradiance is exact at every surface: a pixel needs no directions, only camera rays for its edges.
  virtual bool exact() const { return false; }
  /// Of one pass: what is drawn for them all takes room.
  virtual int most_directions() const { return std::numeric_limits<int>::max(); }
  /// Where in the picture its records are.
  virtual std::vector<Vec2f> record_points() const { return {}; }
  /// What comes out is a share, shown as it is on every material: neither light nor an albedo takes part.
  virtual bool openness() const { return false; }
};

/// Keeps in `wanted` the places from which nothing is in the way of `rays`, which start at places of `at`.
class Visibility {
 public:
  Visibility(const Tracer& tracer, bool convex) : tracer_(tracer), convex_(convex) {}
  void keep(const Surfaces& at, const RayArrays& rays, Spread spread, std::span<std::int32_t> wanted,
            std::int64_t& traced) const {
    if (!(convex_ && at.fronts)) traced += tracer_.visible(rays, wanted, spread);
  }

 private:
  const Tracer& tracer_;
  bool convex_;
};

/// How many of a pass's directions are drawn from the probe, how many from the surface.
struct ProbeShare {
  int of_probe, of_surface;
};
ProbeShare probe_share(const Pass& pass, double share);

std::unique_ptr<Integrator> make_mc(const Setting& setting);
std::unique_ptr<Integrator> make_mis(const Setting& setting, double share_of_probe);
std::unique_ptr<Integrator> make_structured(const Setting& setting);
std::unique_ptr<Integrator> make_pixels(const Setting& setting);
std::unique_ptr<Integrator> make_cache(const Setting& setting);
std::unique_ptr<Integrator> make_ao(const Setting& setting);  ///< by depth maps where the options say so
std::unique_ptr<Integrator> make_ao_of_depth_maps(const Setting& setting);
std::unique_ptr<Integrator> make_sh(const Setting& setting);
std::unique_ptr<Integrator> make_occluded_sh(const Setting& setting);
std::unique_ptr<Integrator> make_occluded_mean(const Setting& setting);
std::unique_ptr<Integrator> make_prt(const Setting& setting);

/// What kAuto becomes, and why; another method is itself.
struct MethodChoice {
  RenderMethod method;
  int sh_degree = 2;
  std::string reason = {}, skipped = {};
};
MethodChoice choose_method(const Setting& setting);

/// Of `method`, which is none of kAuto.
std::unique_ptr<Integrator> make_integrator(RenderMethod method, const Setting& setting);

}  // namespace hdr
