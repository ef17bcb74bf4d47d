#include "tests/bench/render_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/camera_rays.h"
#include "libhdr/render/prt.h"
#include "libhdr/render/tracer.h"
#include "tests/bench/stopwatch.h"

namespace hdr::bench {
namespace {

Scene on_plane(Mesh mesh) {
  mesh.material = {MaterialKind::kDiffuse, Rgbf::Constant(0.5f), 1};
  float lowest = mesh.positions[0].y();
  for (const Vec3f& p : mesh.positions) lowest = std::min(lowest, p.y());
  for (Vec3f& p : mesh.positions) p.y() -= lowest;
  Scene scene;
  scene.meshes.push_back(std::move(mesh));
  scene.meshes.push_back(plane_mesh(6, 0, scene.meshes[0].material));
  scene.camera = {{1.2f, 2.6f, 5.0f}, {0, 0.85f, 0}, 45};
  return scene;
}

}  // namespace

Scene folded_ball_on_plane(int segments) {
  Mesh mesh = sphere_mesh({0, 0, 0}, 1, {}, segments);
  for (Vec3f& p : mesh.positions) {
    const float folds =
        std::sin(9 * p.x() + 2 * std::sin(4 * p.y())) * std::sin(8 * p.z() + p.x()) * std::sin(7 * p.y() + 2 * p.z());
    p *= 1 + 0.35f * folds;
  }
  mesh.normals.clear();
  return on_plane(with_smooth_normals(std::move(mesh)));
}

Scene mesh_on_plane(Mesh mesh, std::size_t triangles) {
  Vec3f low = mesh.positions[0], high = low;
  for (const Vec3f& p : mesh.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const float scale = 2.4f / (high - low).maxCoeff();
  for (Vec3f& p : mesh.positions) p = scale * (p - 0.5f * (low + high));
  mesh = with_smooth_normals(std::move(mesh));
  for (float longest = 1; mesh.indices.size() / 3 < triangles && longest > 1e-3f; longest *= 0.8f)
    mesh = tessellated(std::move(mesh), longest);
  return on_plane(std::move(mesh));
}

Image<float> sunny_sky(int width) {
  Image<float> map(width, width / 2, 3);
  const Vec3 sun = Vec3(0.5, 0.7, 0.45).normalized();
  const double radius = 0.27 * kDegree, sun_solid_angle = 2 * kPi * (1 - std::cos(radius));
  const double sun_radiance = 4 * kPi * 0.45 / (sun_solid_angle * sun.y());
  for_rows(map.height(), 8, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < width; ++x) {
        int in_sun = 0;  // of 8 x 8 points of the pixel
        const Vec3 d = dir_from_latlong((x + 0.5) / width, (y + 0.5) / map.height());
        if (d.dot(sun) > std::cos(radius + 8.0 / width)) {
          for (int k = 0; k < 64; ++k) {
            const Vec3 at = dir_from_latlong((x + (k % 8 + 0.5) / 8) / width, (y + (k / 8 + 0.5) / 8) / map.height());
            in_sun += at.dot(sun) > std::cos(radius);
          }
        }
        const double haze = std::exp(-6 * std::max(d.y(), 0.0)), glow = std::exp(40 * (d.dot(sun) - 1));
        for (int c = 0; c < 3; ++c) {
          const double sky = d.y() > 0 ? 0.25 + 0.15 * c + 0.5 * haze + 2 * glow : 0.18 - 0.03 * c;
          map(x, y, c) = static_cast<float>(sky + sun_radiance * (1 - 0.1 * c) * in_sun / 64);
        }
      }
    }
  });
  return map;
}

namespace {

RTCScene raw_scene(RTCDevice device, const Scene& scene) {
  const RTCScene tree = rtcNewScene(device);
  for (const Mesh& mesh : scene.meshes) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.positions.size()));
    for (std::size_t k = 0; k < mesh.positions.size(); ++k) std::copy_n(mesh.positions[k].data(), 3, vertices + 3 * k);
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.indices.size() / 3));
    std::copy(mesh.indices.begin(), mesh.indices.end(), indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(tree, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(tree);
  return tree;
}

// Hits of one camera ray through the middle of each pixel, tiles of 8 x 8 in blocks of 4 x 4.
std::vector<Hit> middle_hits(const Scene& scene, Size size) {
  const Tracer tracer(scene);
  const CameraRays camera(scene.camera, size);
  std::vector<Hit> hits;
  for (int top = 0; top < size.height; top += 8) {
    for (int left = 0; left < size.width; left += 8) {
      for (int k = 0; k < 64; ++k) {
        const int x = left + k % 4 + 4 * (k / 16 % 2), y = top + k / 4 % 4 + 4 * (k / 32);
        if (x >= size.width || y >= size.height) continue;
        if (const auto hit = tracer.intersect(camera.eye(), camera.dir_from_px({x + 0.5, y + 0.5})))
          hits.push_back(*hit);
      }
    }
  }
  return hits;
}

// Rays of 64 hits, as Embree takes them fastest.
struct Stream {
  alignas(64) float origin[3][64], dir[3][64], zero[64], far[64];
  alignas(64) unsigned mask[64], none[64];

  RTCRayNp rays() {
    return {origin[0], origin[1], origin[2], zero, dir[0], dir[1], dir[2], zero, far, mask, none, none};
  }
};

// CPU seconds of `rays` rays from each hit, those of 64 hits at a time; the better of Embree's two ways.
template <class Direction>
double traced(RTCScene tree, const std::vector<Hit>& hits, int rays, const Direction& direction) {
  double seconds[2] = {0, 0};
  std::vector<Stream> streams(static_cast<std::size_t>(rays));
  for (std::size_t begin = 0; begin + 64 <= hits.size(); begin += 64) {
    for (std::size_t ray = 0; ray < streams.size(); ++ray) {
      Stream& stream = streams[ray] = Stream{};
      for (std::size_t lane = 0; lane < 64; ++lane) {
        const Hit& hit = hits[begin + lane];
        const Vec3f dir = direction(hit, static_cast<int>(ray), begin + lane);
        for (int c = 0; c < 3; ++c) stream.origin[c][lane] = hit.position[c], stream.dir[c][lane] = dir[c];
        stream.mask[lane] = ~0u;
      }
    }
    for (const bool coherent : {false, true}) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
      for (Stream& stream : streams) std::fill_n(stream.far, 64, std::numeric_limits<float>::infinity());
      const Stopwatch watch;
      for (Stream& stream : streams) {
        const RTCRayNp all = stream.rays();
        rtcOccludedNp(tree, &context, &all, 64);
      }
      seconds[coherent] += watch.elapsed().cpu;
    }
  }
  return std::min(seconds[0], seconds[1]);
}

}  // namespace

RawRates raw_embree_rates(const Scene& scene, Size size, const Vec3f& sun, int rays) {
  const RTCDevice device = rtcNewDevice(nullptr);
  const Stopwatch building;
  const RTCScene tree = raw_scene(device, scene);
  RawRates rates;
  rates.build_seconds = building.elapsed().cpu;
  const std::vector<Hit> hits = middle_hits(scene, size);
  rates.hits = static_cast<double>(hits.size());
  const double traced_rays = static_cast<double>(hits.size() / 64 * 64) * rays;
  const int side = std::max(1, static_cast<int>(std::sqrt(rays)));
  const auto cosine_weighted = [&](const Hit& hit, int k, std::size_t which) {
    Random random(static_cast<std::uint64_t>(k), which);
    const double u = (k / side % side + random.uniform()) / side, v = (k % side + random.uniform()) / side;
    Vec3f t, b;
    tangents_from_normal(hit.normal, t, b);
    const double r = std::sqrt(u), phi = 2 * kPi * v;
    return Vec3f(static_cast<float>(r * std::cos(phi)) * t + static_cast<float>(r * std::sin(phi)) * b +
                 static_cast<float>(std::sqrt(1 - u)) * hit.normal);
  };
  rates.ao = traced_rays / traced(tree, hits, rays, cosine_weighted);
  // Only what faces the sun asks for shadows.
  std::vector<Hit> facing;
  for (const Hit& hit : hits)
    if (hit.normal.dot(sun) > 0) facing.push_back(hit);
  const double sun_rays = static_cast<double>(facing.size() / 64 * 64) * rays;
  rates.sun = sun_rays / traced(tree, facing, rays, [&](const Hit&, int, std::size_t) { return sun; });
  rtcReleaseScene(tree);
  rtcReleaseDevice(device);
  return rates;
}

double rel_rmse(View<const float> picture, View<const float> reference, View<const float> alpha) {
  double mean = 0, sum = 0;
  std::int64_t count = 0;
  for (int y = 0; y < reference.height(); ++y) {
    for (int x = 0; x < reference.width(); ++x) {
      if (alpha(x, y) < 0.999f) continue;
      for (int c = 0; c < 3; ++c) mean += static_cast<double>(reference(x, y, c));
      count += 3;
    }
  }
  mean /= static_cast<double>(std::max<std::int64_t>(count, 1));
  for (int y = 0; y < reference.height(); ++y) {
    for (int x = 0; x < reference.width(); ++x) {
      if (alpha(x, y) < 0.999f) continue;
      for (int c = 0; c < 3; ++c) {
        const double r = static_cast<double>(reference(x, y, c)), d = static_cast<double>(picture(x, y, c)) - r;
        sum += d * d / (r * r + 0.01 * mean * mean);
      }
    }
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::int64_t>(count, 1)));
}

}  // namespace hdr::bench
