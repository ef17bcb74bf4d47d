#include "libhdr/render/tracer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "libhdr/core/parallel.h"
#include "libhdr/render/internal/ray_streams.h"

namespace hdr {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

RTCRay ray_from(const Vec3f& origin, const Vec3f& dir) {
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = dir.x();
  ray.dir_y = dir.y();
  ray.dir_z = dir.z();
  ray.tnear = 0;
  ray.tfar = kFar;
  ray.mask = ~0u;
  return ray;
}

struct Triangle {
  std::array<Vec3f, 3> p;
  std::array<Vec3f, 3> n;  ///< zero where the mesh is flat

  Vec3f geometric() const { return (p[1] - p[0]).cross(p[2] - p[0]); }
  float extent() const {
    return std::max({p[0].cwiseAbs().maxCoeff(), p[1].cwiseAbs().maxCoeff(), p[2].cwiseAbs().maxCoeff()});
  }
};

Triangle triangle_of(const Mesh& mesh, std::size_t primitive) {
  Triangle triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = mesh.indices[3 * primitive + k];
    triangle.p[k] = mesh.positions[vertex];
    triangle.n[k] = mesh.normals.empty() ? Vec3f(Vec3f::Zero()) : mesh.normals[vertex];
  }
  return triangle;
}

// A point of a facet lies inside the smooth surface that the facet stands for, and rays that the shading normal calls
// visible would meet neighbouring facets: a dark ring where light grazes. Moved to the mean of its projections on the
// tangent planes of the vertices, weighted as the point is, it lies on or outside the smooth surface [Hanika21].
Vec3f lifted_to_smooth_surface(const Triangle& triangle, const std::array<float, 3>& weights, const Vec3f& point,
                               float side) {
  Vec3f lift = Vec3f::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f n = side * triangle.n[k];
    lift -= weights[k] * std::min(0.0f, (point - triangle.p[k]).dot(n)) * n;
  }
  return point + lift;
}

// A smooth normal may look away from a viewer who sees the facet at a grazing angle: bent back to his horizon.
Vec3f bent_towards(const Vec3f& viewer, const Vec3f& normal) {
  constexpr float kHorizon = 1e-3f;
  const float cosine = normal.dot(viewer);
  if (cosine >= kHorizon) return normal;
  return (normal + (kHorizon - cosine) * viewer).normalized();
}

// Where Embree found a triangle.
struct Corner {
  std::uint32_t triangle, mesh;
  float u, v;
};

Hit hit_of(const Mesh& mesh, const Corner& found, const Vec3f& dir) {
  const Triangle triangle = triangle_of(mesh, found.triangle);
  const std::array<float, 3> weights{1 - found.u - found.v, found.u, found.v};
  Hit hit;
  hit.material = &mesh.material;
  hit.mesh = found.mesh;
  hit.triangle = found.triangle;
  hit.weights = weights;
  hit.geometric = triangle.geometric().normalized();
  hit.front = hit.geometric.dot(dir) < 0;
  const float side = hit.front ? 1.0f : -1.0f;
  hit.geometric *= side;
  const Vec3f point = weights[0] * triangle.p[0] + weights[1] * triangle.p[1] + weights[2] * triangle.p[2];
  const Vec3f smooth = weights[0] * triangle.n[0] + weights[1] * triangle.n[1] + weights[2] * triangle.n[2];
  const bool flat = smooth.squaredNorm() < 1e-12f;
  hit.normal = bent_towards(-dir, flat ? hit.geometric : Vec3f(side * smooth.normalized()));
  hit.position = flat ? point : lifted_to_smooth_surface(triangle, weights, point, side);
  // The interpolated point is off its plane by some units in the last place of the vertices.
  constexpr float kUnitsInLastPlace = 16 * std::numeric_limits<float>::epsilon();
  hit.position += kUnitsInLastPlace * triangle.extent() * hit.geometric;
  return hit;
}

}  // namespace

struct Tracer::Impl {
  Impl(const Scene& from, Effort effort) : scene(from), device(rtcNewDevice(nullptr)), tree(rtcNewScene(device)) {
    // Not RTC_SCENE_FLAG_ROBUST: of 1e8 rays from inside a closed mesh 13 slipped out between triangles, and it costs a
    // fifth of the rays a second.
    rtcSetSceneBuildQuality(tree, effort == Effort::kFewRays ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM);
    for (const Mesh& mesh : scene.meshes) attach(mesh);
    rtcCommitScene(tree);
  }
  ~Impl() {
    rtcReleaseScene(tree);
    rtcReleaseDevice(device);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void attach(const Mesh& mesh) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree may read 16 bytes from the last vertex on: a buffer of its own has the room.
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.positions.size()));
    for (std::size_t k = 0; k < mesh.positions.size(); ++k) std::copy_n(mesh.positions[k].data(), 3, vertices + 3 * k);
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.indices.size() / 3));
    std::copy(mesh.indices.begin(), mesh.indices.end(), indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(tree, geometry);
    rtcReleaseGeometry(geometry);
  }

  const Scene& scene;
  RTCDevice device;
  RTCScene tree;
};

Tracer::Tracer(const Scene& scene, Effort effort) : impl_(std::make_unique<Impl>(scene, effort)) {}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;

std::optional<Hit> Tracer::intersect(const Vec3f& origin, const Vec3f& dir) const {
  RTCRayHit found{};
  found.ray = ray_from(origin, dir);
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->tree, &context, &found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Corner corner{found.hit.primID, found.hit.geomID, found.hit.u, found.hit.v};
  return hit_of(impl_->scene.meshes[corner.mesh], corner, dir);
}

bool Tracer::occluded(const Vec3f& origin, const Vec3f& dir) const {
  RTCRay ray = ray_from(origin, dir);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->tree, &context, &ray);
  return ray.tfar < 0;  // Embree's sign for "something is in the way"
}

void Tracer::intersect(const RayArrays& rays, std::span<std::optional<Hit>> hits, Spread spread) const {
  RayStream stream(impl_->tree, spread);
  RayStream::Hits found;
  for (std::size_t first = 0; first < hits.size(); first += RayStream::kMost) {
    const std::size_t count = std::min(RayStream::kMost, hits.size() - first);
    stream.intersect(rays, first, count, found);
    for (std::size_t k = 0; k < count; ++k) {
      std::optional<Hit>& hit = hits[first + k];
      hit.reset();
      if (found.mesh[k] == RTC_INVALID_GEOMETRY_ID) continue;
      const Vec3f dir(rays.dir_x[first + k], rays.dir_y[first + k], rays.dir_z[first + k]);
      hit = hit_of(impl_->scene.meshes[found.mesh[k]], {found.triangle[k], found.mesh[k], found.u[k], found.v[k]}, dir);
    }
  }
}

void Tracer::distances(const RayArrays& rays, std::span<float> far, Spread spread) const {
  RayStream stream(impl_->tree, spread);
  RayStream::Hits found;
  for (std::size_t first = 0; first < far.size(); first += RayStream::kMost) {
    const std::size_t count = std::min(RayStream::kMost, far.size() - first);
    stream.intersect(rays, first, count, found);
    std::copy_n(found.far.begin(), count, far.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

int Tracer::visible(const RayArrays& rays, std::span<std::int32_t> wanted, Spread spread) const {
  HDR_ASSERT(wanted.size() % kPacket == 0);
  return trace_occlusion(impl_->tree, rays, spread, wanted);
}

bool Tracer::convex() const {
  std::vector<float> xs, ys, zs;
  for (const Mesh& mesh : impl_->scene.meshes) {
    for (const Vec3f& p : mesh.positions) {
      xs.push_back(p.x());
      ys.push_back(p.y());
      zs.push_back(p.z());
    }
  }
  if (xs.empty()) return true;
  // Proving that no ray is needed would take longer than tracing them.
  constexpr double kMostWork = 4e9;
  double triangles = 0;
  for (const Mesh& mesh : impl_->scene.meshes) triangles += static_cast<double>(mesh.indices.size()) / 3;
  if (triangles * static_cast<double>(xs.size()) > kMostWork) return false;
  const auto count = static_cast<Eigen::Index>(xs.size());
  const Eigen::Map<const Eigen::ArrayXf> x(xs.data(), count), y(ys.data(), count), z(zs.data(), count);
  // Rounded vertices may stand this far in front of a plane on which they should lie.
  const float tolerance = 1e-5f * std::max({x.abs().maxCoeff(), y.abs().maxCoeff(), z.abs().maxCoeff()});
  std::atomic<bool> convex = true;
  for (const Mesh& mesh : impl_->scene.meshes) {
    for_rows(static_cast<int>(mesh.indices.size() / 3), 64, [&](int first, int last) {
      for (int primitive = first; primitive < last && convex; ++primitive) {
        const Triangle triangle = triangle_of(mesh, static_cast<std::size_t>(primitive));
        const Vec3f n = triangle.geometric().normalized();
        const float highest = (n.x() * x + n.y() * y + n.z() * z).maxCoeff();
        if (highest > n.dot(triangle.p[0]) + tolerance) convex = false;
      }
    });
  }
  return convex;
}

}  // namespace hdr
