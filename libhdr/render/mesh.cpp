// Normals and finer triangles for meshes.
#include <algorithm>
#include <cmath>
#include <map>

#include "libhdr/render/prt.h"

namespace hdr {
namespace {

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

float longest_edge(const Mesh& mesh) {
  float longest = 0;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f edge = mesh.positions[mesh.indices[t + k]] - mesh.positions[mesh.indices[t + (k + 1) % 3]];
      longest = std::max(longest, edge.norm());
    }
  }
  return longest;
}

Mesh quartered(const Mesh& mesh) {
  Mesh fine;
  fine.material = mesh.material;
  fine.positions = mesh.positions;
  fine.normals = mesh.normals;
  fine.texcoords = mesh.texcoords;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [found, fresh] =
        middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(fine.positions.size()));
    if (fresh) {
      fine.positions.push_back(0.5f * (mesh.positions[a] + mesh.positions[b]));
      if (!mesh.normals.empty()) fine.normals.push_back((mesh.normals[a] + mesh.normals[b]).normalized());
      if (!mesh.texcoords.empty()) fine.texcoords.push_back(0.5f * (mesh.texcoords[a] + mesh.texcoords[b]));
    }
    return found->second;
  };
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const std::uint32_t a = mesh.indices[t], b = mesh.indices[t + 1], c = mesh.indices[t + 2];
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.indices.insert(fine.indices.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
  }
  return fine;
}

}  // namespace

Mesh with_smooth_normals(Mesh mesh) {
  if (!mesh.normals.empty()) return mesh;
  std::vector<Vec3> sums(mesh.positions.size(), Vec3::Zero());
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const auto p = [&](std::size_t k) { return Vec3(mesh.positions[mesh.indices[t + k % 3]].cast<double>()); };
    const Vec3 normal = (p(1) - p(0)).cross(p(2) - p(0)).normalized();
    if (!normal.allFinite()) continue;
    for (std::size_t k = 0; k < 3; ++k)
      sums[mesh.indices[t + k]] += angle_between(p(k + 1) - p(k), p(k + 2) - p(k)) * normal;
  }
  // A vertex of no triangle, or between opposite ones, looks up.
  for (const Vec3& sum : sums)
    mesh.normals.push_back(sum.norm() > 1e-12 ? Vec3f(sum.normalized().cast<float>()) : Vec3f(0, 1, 0));
  return mesh;
}

Mesh tessellated(Mesh mesh, float longest) {
  constexpr std::size_t kMostIndices = 12000000;
  while (longest_edge(mesh) > longest && 4 * mesh.indices.size() <= kMostIndices) mesh = quartered(mesh);
  return mesh;
}

}  // namespace hdr
