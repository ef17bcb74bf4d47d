#include "libhdr/render/framing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
};

Box box_of(const Scene& scene) {
  Box box;
  for (const Mesh& mesh : scene.meshes) {
    for (const std::uint32_t v : mesh.indices) {
      const Vec3 p = mesh.positions[v].cast<double>();
      box.low = box.low.cwiseMin(p);
      box.high = box.high.cwiseMax(p);
    }
  }
  if (!(box.low.x() <= box.high.x())) throw Error("nothing to look at: the scene has no triangles");
  return box;
}

// Of points (x, z), z pointing from the scene to the camera: the apex of the tightest wedge |x - apex.x| <=
// slope (apex.z - z) around them. Each side touches a point: x + slope z <= apex.x + slope apex.z and its mirror.
struct Wedge {
  double slope;
  double right = -std::numeric_limits<double>::max(), left = right;

  void hold(double x, double z) {
    right = std::max(right, x + slope * z);
    left = std::max(left, -x + slope * z);
  }
  double x() const { return 0.5 * (right - left); }
  double z() const { return 0.5 * (right + left) / slope; }
};

}  // namespace

Vec3f middle_of(const Scene& scene) {
  const Box box = box_of(scene);
  return (0.5 * (box.low + box.high)).cast<float>();
}

Camera framing_camera(const Scene& scene, double aspect, double fov_degrees) {
  if (!(fov_degrees > 0 && fov_degrees < 180)) throw Error("--fov: give degrees between 0 and 180");
  HDR_ASSERT(aspect > 0);
  const Box box = box_of(scene);
  const Vec3 middle = 0.5 * (box.low + box.high);
  const Vec3 back = Vec3(0.6, 0.9, 3.4).normalized();  // from the scene to the camera
  const Vec3 right = Vec3::UnitY().cross(back).normalized(), up = back.cross(right);
  constexpr double kMargin = 0.92;  // of the half picture
  const double slope = kMargin * std::tan(0.5 * fov_degrees * kDegree);
  Wedge across{slope}, upwards{slope / aspect};
  double nearest = -std::numeric_limits<double>::max();
  for (const Mesh& mesh : scene.meshes) {
    for (const std::uint32_t v : mesh.indices) {
      const Vec3 p = mesh.positions[v].cast<double>() - middle;
      across.hold(p.dot(right), p.dot(back));
      upwards.hold(p.dot(up), p.dot(back));
      nearest = std::max(nearest, p.dot(back));
    }
  }
  const double extent = (box.high - box.low).norm();
  // Floats far from the origin cannot tell an eye from what it looks at when both are nearer than this.
  const double least = std::max(1e-4 * middle.norm(), extent > 0 ? 0.02 * extent : 1.0);
  const double distance = std::max({across.z(), upwards.z(), nearest + least});
  const Vec3 eye = middle + across.x() * right + upwards.x() * up + distance * back;
  Camera camera;
  camera.eye = eye.cast<float>();
  camera.look = (eye - distance * back).cast<float>();
  if (camera.eye == camera.look) camera.look = (eye - (1 + eye.norm()) * back).cast<float>();
  camera.fov_degrees = fov_degrees;
  return camera;
}

}  // namespace hdr
