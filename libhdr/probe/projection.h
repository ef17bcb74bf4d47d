#pragma once
// Pixels <-> directions. A projection is a pair
//   dir_from_px: pixel (continuous, y down) -> unit direction, nullopt outside the picture's disc or frame
//   px_from_dir: direction -> pixel, nullopt where the picture does not show it
// Axes are those of core/sphere.h. A new projection: add a struct with the pair and its name, add it to the variant,
// and the templated test in tests/unit/probe takes it from there.
#include <limits>
#include <optional>
#include <string>
#include <variant>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// A circle in continuous pixel coordinates.
struct Disc {
  double cx = 0, cy = 0, r = 0;
};
/// The disc inscribed in a square picture.
inline Disc inscribed_disc(int width) {
  return {0.5 * width, 0.5 * width, 0.5 * width};
}

struct LatLong {
  static constexpr const char* kName = "latlong";
  Size size;
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;
};

/// Debevec's angular map: radius = angle from +Z / pi, the rim is -Z.
struct AngularMap {
  static constexpr const char* kName = "angular";
  Disc disc;
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;
};

/// A mirrored sphere whose outline is `disc`, seen by a camera `distance` ball radii from its centre (infinity: far).
/// In between, the true ray of the pinhole camera; behind the ball a cone of half-angle asin(1/distance) is unseen.
/// A distance of 1 or less puts the camera into the ball: Error.
/// Without a principal point the camera's axis goes through the ball's centre: a crop around the ball. With one, the
/// axes are the whole picture's (the camera looks along -Z) and a near ball beside it has an ellipse for outline, whose
/// centre and smaller half-axis are `disc`.
struct MirrorBall {
  static constexpr const char* kName = "mirror-ball";
  Disc disc;
  double distance = std::numeric_limits<double>::infinity();
  std::optional<Vec2> principal{};  ///< where the camera's axis meets the picture
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;
};

/// The ball with this outline in a whole photograph of this horizontal field: the principal point is the picture's
/// middle, and the distance follows. Error for a field outside (0, 180).
MirrorBall ball_in_photograph(const Disc& disc, Size size, double fov_degrees);

/// The angle between the ray that met the ball at a pixel and the ball's normal there, as its cosine in [0, 1]; nullopt
/// outside the outline.
std::optional<double> cos_incidence(const MirrorBall& ball, const Vec2& px);

/// A pinhole camera that looks along +Z.
struct Rectilinear {
  static constexpr const char* kName = "rectilinear";
  Size size;
  double fov_degrees = 90;  ///< horizontal, in (0, 180)
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;
};

using Projection = std::variant<LatLong, AngularMap, MirrorBall, Rectilinear>;

std::optional<Vec3> dir_from_px(const Projection& projection, const Vec2& px);
std::optional<Vec2> px_from_dir(const Projection& projection, const Vec3& dir);

/// Throws Error when a projection cannot be: a camera inside its ball, a disc without radius, a field of 180 degrees.
void require_valid(const Projection& projection);

/// The text of hdr:projection: "latlong", "angular", "mirror-ball cx=1000.5 cy=750 r=600 distance=20", "rectilinear
/// fov=60". Numbers survive the round trip exactly. A far camera has no distance; an angular map that fills its square
/// has no disc.
std::string text_from_projection(const Projection& projection);

/// A name ("latlong", "lat-long", "angular", "mirror-ball", "rectilinear") or a text of the above for a picture of this
/// size; parameters that are absent take their defaults (the inscribed disc, far, 90 degrees). nullopt: unknown name or
/// parameter. Error: a geometry that cannot be.
std::optional<Projection> projection_from_text(const std::string& text, Size size);

/// How a probe file is to be read: `--from` if given, else its hdr:projection, else 2:1 is lat-long; else Error that
/// names --from. A bare name in `--from` takes its geometry from a tag of the same name. `source` is the file's name
/// for the message.
Projection projection_of_probe(const std::string& from, const std::string& tag, Size size, const std::string& source);

}  // namespace hdr
