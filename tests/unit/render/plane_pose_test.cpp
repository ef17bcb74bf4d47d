// A camera from the rectangle that it photographed: cameras that we place, found again.
#include "libhdr/render/plane_pose.h"

#include <gtest/gtest.h>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

constexpr Size kPicture{1200, 800};

Vec2 seen_at(const Camera& camera, const Vec3& p) {
  const Vec3 eye = camera.eye.cast<double>(), ahead = (camera.look.cast<double>() - eye).normalized();
  const Vec3 right = ahead.cross(camera.up.cast<double>()).normalized(), up = right.cross(ahead), d = p - eye;
  const double half = std::tan(0.5 * camera.fov_degrees * kDegree), depth = d.dot(ahead);
  return {0.5 * kPicture.width * (1 + d.dot(right) / (depth * half)),
          0.5 * kPicture.height - 0.5 * kPicture.width * d.dot(up) / (depth * half)};
}

PhotographedRectangle photographed(const Camera& camera, double width, double depth) {
  PhotographedRectangle seen{{}, width, depth};
  const double w = width / 2, d = depth / 2;
  const Vec3 corners[] = {{-w, 0, d}, {w, 0, d}, {w, 0, -d}, {-w, 0, -d}};
  for (std::size_t k = 0; k < 4; ++k) seen.corners[k] = seen_at(camera, corners[k]);
  return seen;
}

Camera some_camera(Random& random) {
  Camera camera;
  const double turn = (random.uniform() - 0.5) * 100 * kDegree, height = 0.8 + 2 * random.uniform();
  const double far = 2.5 + 3 * random.uniform();
  camera.eye = Vec3(far * std::sin(turn), height, far * std::cos(turn)).cast<float>();
  camera.look = Vec3(0.4 * random.normal(), 0.2 * random.normal(), 0.4 * random.normal()).cast<float>();
  camera.fov_degrees = 30 + 50 * random.uniform();
  camera.up = Vec3(0.2 * random.normal(), 1, 0).cast<float>();
  return camera;
}

TEST(PlanePose, FindsTheCameraAgain) {
  int far_off = 0, rough_off = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed, 2);
    const Camera camera = some_camera(random);
    const double width = 0.8 + random.uniform(), depth = 0.8 + random.uniform();
    PhotographedRectangle seen = photographed(camera, width, depth);
    // With its field of view known, and a quarter of a pixel of error in each corner.
    const PlanePose known = pose_from_rectangle(seen, kPicture, camera.fov_degrees);
    EXPECT_LT((known.camera.eye - camera.eye).norm(), 1e-4f) << seed;
    EXPECT_LT(known.residual_px, 1e-3);
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.3, 0.5, -0.2), Vec3(-0.2, 0, 0.4)})
      EXPECT_LT((seen_at(known.camera, p) - seen_at(camera, p)).norm(), 0.02) << seed;
    const PlanePose free = pose_from_rectangle(seen, kPicture);
    far_off += std::abs(free.camera.fov_degrees - camera.fov_degrees) > 0.05;
    for (Vec2& corner : seen.corners) corner += 0.25 * Vec2(random.normal(), random.normal());
    const PlanePose rough = pose_from_rectangle(seen, kPicture, camera.fov_degrees);
    rough_off += (rough.camera.eye - camera.eye).norm() > 0.05f * camera.eye.norm();
    EXPECT_LT(rough.residual_px, 1);
  }
  EXPECT_LE(rough_off, 10) << "of 200; some rectangles are twenty pixels deep";
  EXPECT_LE(far_off, 4) << "of 200 fields of view; one or two rectangles are seen all but straight on";
}

TEST(PlanePose, WhatIsNoRectangleIsRefused) {
  const Camera camera{{0, 2, 4}, {0, 0, 0}, 50};
  const PhotographedRectangle good = photographed(camera, 1, 1);
  PhotographedRectangle crossed = good, backwards = good, flat = good;
  std::swap(crossed.corners[0], crossed.corners[1]);
  std::swap(backwards.corners[1], backwards.corners[3]);
  flat.corners[2] = 0.5 * (flat.corners[1] + flat.corners[3]);
  for (const PhotographedRectangle& bad : {crossed, backwards, flat, PhotographedRectangle{}})
    EXPECT_THROW(pose_from_rectangle(bad, kPicture), Error);
  PhotographedRectangle nothing = good;
  nothing.width = 0;
  EXPECT_THROW(pose_from_rectangle(nothing, kPicture), Error);
  EXPECT_THROW(pose_from_rectangle(good, kPicture, 180), Error);
  // Straight down: any field of view could have seen it so.
  const Camera above{{0, 4, 0}, {0, 0, 0}, 50, {0, 0, -1}};
  EXPECT_THROW(pose_from_rectangle(photographed(above, 1, 1), kPicture), Error);
  EXPECT_LT((pose_from_rectangle(photographed(above, 1, 1), kPicture, 50).camera.eye - above.eye).norm(), 1e-3f);
}

}  // namespace
}  // namespace hdr
