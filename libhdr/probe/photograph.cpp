#include "libhdr/probe/photograph.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/ball_camera.h"
#include "libhdr/probe/internal/footprint.h"
#include "libhdr/probe/internal/source_picture.h"
#include "libhdr/probe/reflectance.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

/// Towards the rim a ball's pixel sees ever more of the scene: the last one some ten degrees.
constexpr int kMostSamples = 128;

/// Focal length in pixels of the camera that sees the ball: the outline's ray leaves the axis by tan A =
/// 1 / sqrt(D^2 - 1) and meets the picture r pixels from the middle. A far camera has the field it is given.
double focal_px(const MirrorBall& ball, int width, double fov_degrees) {
  if (std::isinf(ball.distance)) return 0.5 * width / std::tan(0.5 * fov_degrees * kDegree);
  if (ball.principal) return internal::camera_of(ball).focal_px;
  return ball.disc.r * std::sqrt(ball.distance * ball.distance - 1);
}

/// The environment behind the ball: the camera looks along -Z with image right = +X.
Image<float> backdrop(View<const float> latlong, Size size, const MirrorBall& ball, double focal,
                      const Mat3& scene_from_probe) {
  const LatLong scene{latlong.size()};
  const Vec2 axis = ball.principal.value_or(Vec2(ball.disc.cx, ball.disc.cy));
  const auto scene_from_run = [&](const internal::PixelRun& run, Vec2* scene_px) {
    for (int k = 0; k < run.count; ++k) {
      const Vec2 px = run[k];
      const Vec3 ray((px.x() - axis.x()) / focal, -(px.y() - axis.y()) / focal, -1);
      scene_px[k] = *scene.px_from_dir(scene_from_probe * ray.normalized());
    }
  };
  return internal::average_footprints(internal::SourcePicture(latlong, scene), scene_from_run, size, kMostSamples).mean;
}

}  // namespace

double fov_of_camera(const MirrorBall& ball, int width, double far_fov_degrees) {
  return 2 / kDegree * std::atan(0.5 * width / focal_px(ball, width, far_fov_degrees));
}

Image<float> photograph_view(View<const float> latlong, Size size, double fov_degrees, const Mat3& scene_from_camera) {
  return resample(latlong, LatLong{latlong.size()}, Rectilinear{size, fov_degrees}, size, scene_from_camera);
}

Image<float> photograph_ball(View<const float> latlong, Size size, const MirrorBall& ball, double fov_degrees,
                             const Mat3& scene_from_probe, const Rgb& reflectance) {
  require_valid(Rectilinear{size, fov_degrees});
  require_valid(ball);
  require_reflectance(reflectance);
  const LatLong scene{latlong.size()};
  const internal::Averages mirrored =
      internal::average_footprints(internal::SourcePicture(latlong, scene),
                                   internal::source_from_run(scene, ball, scene_from_probe), size, kMostSamples);
  Image<float> picture = backdrop(latlong, size, ball, focal_px(ball, size.width, fov_degrees), scene_from_probe);
  const bool perfect = (reflectance == 1).all();
  for_rows(size.height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const float share = mirrored.coverage(x, y);
        const Rgb given_back = perfect || share == 0 ? Rgb::Ones() : pixel_reflectance(ball, x, y, reflectance);
        for (int c = 0; c < picture.channels(); ++c) {
          const float mirrored_light = static_cast<float>(given_back[std::min(c, 2)]) * mirrored.mean(x, y, c);
          picture(x, y, c) = share * mirrored_light + (1 - share) * picture(x, y, c);
        }
      }
    }
  });
  return picture;
}

}  // namespace hdr
