// Which projections can be.
#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/projection.h"

namespace hdr {
namespace {

void require_disc(const Disc& disc, const char* name) {
  if (std::isfinite(disc.cx) && std::isfinite(disc.cy) && std::isfinite(disc.r) && disc.r > 0) return;
  throw Error(
      fmt::format("{}: the disc ({}, {}, {}) has no radius; give CX,CY,R in pixels", name, disc.cx, disc.cy, disc.r));
}

void require_size(Size size, const char* name) {
  if (size.width > 0 && size.height > 0) return;
  throw Error(fmt::format("{}: a picture of {}x{} pixels is empty; give a width", name, size.width, size.height));
}

void require(const LatLong& map) {
  require_size(map.size, LatLong::kName);
  if (map.convention == Convention::kOpenGl) {
    throw Error("latlong: OpenGL's convention is of cube maps; give openexr, blender, threejs, pbrt or hdrtoolbox");
  }
}

void require(const Panorama& map) {
  require_size(map.size, Panorama::kName);
  if (!std::isfinite(map.azimuth_degrees)) throw Error("panorama: its middle has no azimuth; give degrees");
  if (!(map.fov_degrees > 0 && map.fov_degrees <= 360)) {
    throw Error(fmt::format("panorama: a field of {} degrees; a turn has 360: crop away what is shown twice (--crop)",
                            map.fov_degrees));
  }
  constexpr double kRounding = 1e-9;
  const double top = map.elevation_degrees + 0.5 * map.vfov_degrees;
  const double bottom = map.elevation_degrees - 0.5 * map.vfov_degrees;
  if (map.vfov_degrees > 0 && top <= 90 + kRounding && bottom >= -90 - kRounding) return;
  throw Error(
      fmt::format("panorama: {} degrees of elevation around {} reach beyond a pole; give --fov, and vfov and elevation "
                  "where its pixels are not square or the horizon is not in its middle",
                  map.vfov_degrees, map.elevation_degrees));
}

void require(const AngularMap& map) {
  require_disc(map.disc, AngularMap::kName);
}

void require(const MirrorBall& ball) {
  require_disc(ball.disc, MirrorBall::kName);
  if (ball.distance > 1) return;
  throw Error(
      fmt::format("mirror-ball: a camera at {} radii is inside the ball; give a distance above 1", ball.distance));
}

void require(const Rectilinear& camera) {
  require_size(camera.size, Rectilinear::kName);
  if (camera.fov_degrees > 0 && camera.fov_degrees < 180) return;
  throw Error(fmt::format("rectilinear: a field of {} degrees; give one between 0 and 180", camera.fov_degrees));
}

double widest_degrees(Lens lens) {
  return lens == Lens::kOrthographic ? 180 : 360;
}

void require(const Fisheye& fisheye) {
  require_disc(fisheye.disc, Fisheye::kName);
  const double fov = fisheye.fov_degrees, widest = widest_degrees(fisheye.lens);
  const bool open = fisheye.lens == Lens::kStereographic;  // its rim lies at infinity there
  if (!(fov > 0 && (open ? fov < widest : fov <= widest))) {
    throw Error(
        fmt::format("fisheye: a field of {} degrees; an {} lens sees at most {}", fov, name_of(fisheye.lens), widest));
  }
  constexpr int kSteps = 256;
  double before = 0;
  for (int k = 1; k <= kSteps; ++k) {
    const double angle = 0.5 * fov * kDegree * k / kSteps;
    const double radius = fisheye.radius_from_angle(angle);
    if (!(radius > before)) {
      throw Error(
          fmt::format("fisheye: with these coefficients the radius stops rising {:.1f} degrees from the axis; "
                      "give other ones, or a smaller field",
                      angle / kDegree));
    }
    before = radius;
  }
}

void require(const Cube& cube) {
  if (cube.face_px < 1) throw Error("cube: faces of no pixel; give a width");
  const Convention c = cube.convention;
  if (c == Convention::kOpenExr || c == Convention::kOpenGl || c == Convention::kThreeJs) return;
  throw Error(fmt::format("cube: '{}' has no convention for cube maps; give openexr, opengl or threejs", name_of(c)));
}

void require(const Octahedral& map) {
  require_size(map.size, Octahedral::kName);
  if (map.size.width == map.size.height) return;
  throw Error(fmt::format("octahedral: a picture of {}x{} pixels is not square", map.size.width, map.size.height));
}

void require(const Hemisphere& map) {
  require_disc(map.disc, Hemisphere::kName);
}

void require(const DualParaboloid& map) {
  require_size(map.size, DualParaboloid::kName);
  if (map.size.width == 2 * map.size.height) return;
  throw Error(fmt::format("dual-paraboloid: a picture of {}x{} pixels is not twice as wide as high", map.size.width,
                          map.size.height));
}

}  // namespace

void require_valid(const Projection& projection) {
  std::visit([](const auto& p) { require(p); }, projection);
}

}  // namespace hdr
