#pragma once
// Pixels <-> directions. A projection is a pair
//   dir_from_px: pixel (continuous, y down) -> unit direction, nullopt outside the picture's disc or frame
//   px_from_dir: direction -> pixel, nullopt where the picture does not show it
// Axes are those of core/sphere.h. A new projection: add a struct with the pair and its name, add it to the variant,
// say its text (projection_text.cpp) and what cannot be (require_valid), and the templated test in tests/unit/probe
// takes it from there.
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <variant>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/convention.h"

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
  Convention convention = Convention::kOpenExr;
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;
};

/// A lat-long of a part of the sphere, as panoramic cameras scan it: `fov_degrees` of azimuth by `vfov_degrees` of
/// elevation around a middle that lies `azimuth_degrees` to the right of +Z and `elevation_degrees` above the horizon.
/// All around, its left and right borders meet.
struct Panorama {
  static constexpr const char* kName = "panorama";
  Size size;
  double fov_degrees = 360;   ///< in (0, 360]
  double vfov_degrees = 180;  ///< in (0, 180]; neither border may lie beyond a pole
  double azimuth_degrees = 0, elevation_degrees = 0;
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;

  bool closes() const { return fov_degrees >= 360; }
};

/// What a rectangle of the picture shows: x, y its upper left pixel. Error when it is not inside the picture.
Panorama cropped(const Panorama& panorama, int x, int y, Size size);

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

/// How a fisheye lens maps the angle theta from its axis (radians) to a radius. The first four are the ideal lenses;
/// [Kannala06] eq. 6 is theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8); the polynomial is
/// theta (1 + k1 theta + k2 theta^2 + k3 theta^3 + k4 theta^4).
enum class Lens { kEquidistant, kEquisolid, kStereographic, kOrthographic, kPolynomial, kKannalaBrandt };

/// A fisheye photograph along +Z. Its image circle `disc` shows what is fov_degrees / 2 from the axis, whatever the
/// lens: radius = disc.r f(theta) / f(fov / 2).
struct Fisheye {
  static constexpr const char* kName = "fisheye";
  Disc disc;
  double fov_degrees = 180;  ///< across the image circle, in (0, 360]; what a lens can: 180 orthographic
  Lens lens = Lens::kEquidistant;
  std::array<double, 4> k{};  ///< of the last two lenses; the radius must rise with the angle over the whole field
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;

  double radius_from_angle(double theta) const;  ///< f, not scaled to the disc
};

const char* name_of(Lens lens);
std::optional<Lens> lens_from_name(const std::string& name);

/// Lens distortion of a pinhole camera, [Brown66] as OpenCV writes it: with (x, y) on the plane at distance 1, y down,
/// and r^2 = x^2 + y^2, the point is moved to
///   x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2), y (...) + p1 (r^2 + 2 y^2) + 2 p2 x y.
struct BrownConrady {
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  bool operator==(const BrownConrady&) const = default;
};

/// A pinhole camera that looks along +Z.
struct Rectilinear {
  static constexpr const char* kName = "rectilinear";
  Size size;
  double fov_degrees = 90;  ///< horizontal, in (0, 180), of the lens without its distortion
  BrownConrady distortion;
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;

  double focal_px() const;
};

/// Six square faces. A cross is unfolded around +Z, its rows as a lat-long's: up, (left, front, right, back) and down,
/// the vertical one with the back below, upside down. A strip has +X -X +Y -Y +Z -Z from top to bottom, as OpenEXR, or
/// from left to right; `faces` are six pictures in that order, which in memory stand one above the other. How a face is
/// turned in a strip follows the convention: openexr, opengl or threejs.
struct Cube {
  enum class Layout { kHorizontalCross, kVerticalCross, kVerticalStrip, kHorizontalStrip, kFaces };
  static constexpr const char* kName = "cube";
  Layout layout = Layout::kHorizontalCross;
  int face_px = 0;
  Convention convention = Convention::kOpenExr;
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;

  Size size() const;
  /// A face in the picture: its cell, and the directions of its picture's right, of its picture's down, and of its
  /// middle, as signed axes 1 = +X, -1 = -X, 2 = +Y ... 3 = +Z.
  struct Face {
    int column, row, right, down, front;
  };
  std::array<Face, 6> faces() const;
};

/// The sphere folded onto a square [Meyer10] with +Y in the middle and -Y in the corners: image right = +X, image down
/// = +Z of the upper half, |x| + |y| + |z| = 1; or its equal-area version [Clarberg08], which pbrt-v4 uses.
struct Octahedral {
  static constexpr const char* kName = "octahedral";
  Size size;
  bool equal_area = false;
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;
};

/// The upper half of the sphere as a dome master shows it: an equidistant disc, the zenith in the middle, seen from
/// below, with image down = +Z and image right = -X.
struct Hemisphere {
  static constexpr const char* kName = "hemisphere";
  Disc disc;
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;
};

/// Two discs side by side [Heidrich98]: to the left what a camera along +Z sees, to the right one along -Z, both with
/// +Y up; a direction at angle theta from the axis at radius tan(theta / 2).
struct DualParaboloid {
  static constexpr const char* kName = "dual-paraboloid";
  Size size;  ///< twice as wide as high
  std::optional<Vec3> dir_from_px(const Vec2& px) const;
  std::optional<Vec2> px_from_dir(const Vec3& dir) const;
};

using Projection = std::variant<LatLong, Panorama, AngularMap, MirrorBall, Rectilinear, Fisheye, Cube, Octahedral,
                                Hemisphere, DualParaboloid>;

std::optional<Vec3> dir_from_px(const Projection& projection, const Vec2& px);
std::optional<Vec2> px_from_dir(const Projection& projection, const Vec3& dir);

/// A lat-long in the axes of core/sphere.h, which others compute with row by row.
bool is_plain_latlong(const Projection& projection);

/// The circle outside which a picture with one disc shows nothing.
std::optional<Disc> disc_of(const Projection& projection);

/// Throws Error when a projection cannot be: a camera inside its ball, a disc without radius, a field of 180 degrees.
void require_valid(const Projection& projection);

/// Whether the whole sphere is shown (but for a cone behind a mirror ball).
bool shows_whole_sphere(const Projection& projection);

/// The text of hdr:projection: "latlong", "angular", "mirror-ball cx=1000.5 cy=750 r=600 distance=20", "rectilinear
/// fov=60", "panorama fov=180 vfov=90 azimuth=30 elevation=0", "fisheye cx=500 cy=500 r=480 fov=190 lens=equisolid",
/// "cube-strip convention=opengl". Numbers survive the round trip exactly. A far camera has no distance; an angular map
/// that fills its square has no disc; what is at its default is left out.
std::string text_from_projection(const Projection& projection);

/// A name ("latlong" or "lat-long", "angular", "mirror-ball", "fisheye", "rectilinear", "cube-cross" (the picture's
/// shape says which), "cube-cross-vertical", "cube-strip" (likewise), "cube-faces", "octahedral", "hemisphere",
/// "dual-paraboloid", "panorama") or a text of the above for a picture of this size; parameters that are absent take
/// their defaults (the inscribed disc, far, 90 degrees, fisheyes 180). nullopt: unknown name or parameter. Error: a
/// geometry that cannot be, such as a cube whose faces are not square. A panorama of the whole sphere is a LatLong;
/// without vfov its pixels are square.
std::optional<Projection> projection_from_text(const std::string& text, Size size);

/// The projection of this name (as above) and the size of its picture, for a picture of a given width to be written:
/// discs are inscribed in a square, a lat-long is twice as wide as high, a panorama has square pixels at the horizon,
/// cube-faces are squares of that width, a strip is vertical. nullopt: unknown. Error: a width that faces do not
/// divide.
struct NewPicture {
  Projection projection;
  Size size;
};
std::optional<NewPicture> picture_of_width(const std::string& text, int width);

/// How a probe file is to be read: `--from` if given, else its hdr:projection, else 2:1 is lat-long; else Error that
/// names --from. A bare name in `--from` takes its geometry from a tag of the same name. `source` is the file's name
/// for the message.
Projection projection_of_probe(const std::string& from, const std::string& tag, Size size, const std::string& source);

/// "lat-long, angular, ...": for messages and --help.
extern const char* const kProjectionNames;

}  // namespace hdr
