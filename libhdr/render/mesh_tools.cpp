#include "libhdr/render/internal/mesh_tools.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

constexpr std::uint32_t kNone = ~0u;

Vec3 corner(const Mesh& mesh, std::size_t index) {
  return mesh.positions[mesh.indices[index]].cast<double>();
}

bool has_area(const Mesh& mesh, std::size_t first) {
  const Vec3 a = corner(mesh, first), b = corner(mesh, first + 1), c = corner(mesh, first + 2);
  const double longest2 = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  // Of three points in a line, rounded to floats and far from the origin, nothing more is left of an area.
  constexpr double kSliver = 1e-10;
  return (b - a).cross(c - a).norm() > kSliver * longest2;
}

bool same_vertex(const Mesh& mesh, std::size_t a, std::size_t b) {
  const auto equal = [](const auto& list, std::size_t i, std::size_t j) {
    return list.empty() || std::memcmp(&list[i], &list[j], sizeof(list[i])) == 0;
  };
  return equal(mesh.positions, a, b) && equal(mesh.normals, a, b) && equal(mesh.texcoords, a, b);
}

std::uint64_t hash_of(const Mesh& mesh, std::size_t v) {
  std::uint64_t hash = 0;
  const auto mix = [&](const auto& list) {
    if (list.empty()) return;
    for (const float x : list[v]) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, &x, sizeof bits);
      hash = hash64(hash ^ bits);
    }
  };
  mix(mesh.positions);
  mix(mesh.normals);
  mix(mesh.texcoords);
  return hash;
}

// A hash table of vertex numbers, open addressing, at most half full: each vertex's first equal.
template <class Hash, class Same>
std::vector<std::uint32_t> first_equals(std::size_t count, const Hash& hash, const Same& same) {
  std::size_t slots = 16;
  while (slots < 2 * count) slots *= 2;
  std::vector<std::uint32_t> table(slots, kNone), first(count);
  for (std::size_t v = 0; v < count; ++v) {
    std::size_t slot = hash(v) & (slots - 1);
    while (table[slot] != kNone && !same(table[slot], v)) slot = (slot + 1) & (slots - 1);
    if (table[slot] == kNone) table[slot] = static_cast<std::uint32_t>(v);
    first[v] = table[slot];
  }
  return first;
}

// Which triangles' corners are at each place: those of place p are corners[first[p]] .. corners[first[p + 1]]. A place
// may have several vertices (seams of a texture) and has the number of the first of them.
struct Around {
  std::vector<std::uint32_t> first, corners;
};

Around corners_around(const Mesh& mesh) {
  Mesh places;
  places.positions = mesh.positions;
  const std::vector<std::uint32_t> place = first_equals(
      mesh.positions.size(), [&](std::size_t v) { return hash_of(places, v); },
      [&](std::size_t a, std::size_t b) { return same_vertex(places, a, b); });
  Around around;
  around.first.assign(mesh.positions.size() + 1, 0);
  for (const std::uint32_t v : mesh.indices) ++around.first[place[v] + 1];
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) around.first[v + 1] += around.first[v];
  around.corners.resize(mesh.indices.size());
  std::vector<std::uint32_t> next = around.first;
  for (std::size_t k = 0; k < mesh.indices.size(); ++k)
    around.corners[next[place[mesh.indices[k]]]++] = static_cast<std::uint32_t>(k);
  return around;
}

// Unit normal of a corner's triangle, and the angle that the triangle has there.
struct Facet {
  Vec3f normal = Vec3f::Zero();
  float angle = 0;
};

Facet facet_at(const Mesh& mesh, std::size_t index) {
  const std::size_t first = index / 3 * 3, k = index % 3;
  const Vec3 p = corner(mesh, index), q = corner(mesh, first + (k + 1) % 3), r = corner(mesh, first + (k + 2) % 3);
  const Vec3 normal = (q - p).cross(r - p);
  if (!(normal.norm() > 0)) return {};
  return {normal.normalized().cast<float>(), static_cast<float>(std::atan2(normal.norm(), (q - p).dot(r - p)))};
}

}  // namespace

std::int64_t drop_degenerate(Mesh& mesh) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    if (!has_area(mesh, t)) continue;
    if (kept != t)
      std::copy_n(mesh.indices.begin() + static_cast<std::ptrdiff_t>(t), 3,
                  mesh.indices.begin() + static_cast<std::ptrdiff_t>(kept));
    kept += 3;
  }
  const auto dropped = static_cast<std::int64_t>((mesh.indices.size() - kept) / 3);
  mesh.indices.resize(kept);
  return dropped;
}

void join_vertices(Mesh& mesh) {
  std::vector<std::uint32_t> first = first_equals(
      mesh.positions.size(), [&](std::size_t v) { return hash_of(mesh, v); },
      [&](std::size_t a, std::size_t b) { return same_vertex(mesh, a, b); });
  std::uint32_t kept = 0;
  const auto keep = [&](auto& list, std::size_t v) {
    if (!list.empty()) list[kept] = list[v];
  };
  // Now a vertex's first equal, then that one's new number: firsts come before the others.
  for (std::size_t v = 0; v < first.size(); ++v) {
    if (first[v] != v) {
      first[v] = first[first[v]];
      continue;
    }
    keep(mesh.positions, v);
    keep(mesh.normals, v);
    keep(mesh.texcoords, v);
    first[v] = kept++;
  }
  mesh.positions.resize(kept);
  if (!mesh.normals.empty()) mesh.normals.resize(kept);
  if (!mesh.texcoords.empty()) mesh.texcoords.resize(kept);
  for (std::uint32_t& index : mesh.indices) index = first[index];
}

namespace {

// Vertices that a place's corners get: by what vertex they had, and by their normal.
class Splitter {
 public:
  explicit Splitter(Mesh& mesh) : mesh_(mesh), normals_(mesh.positions.size(), Vec3f::Zero()) {}

  void next_place() { made_.clear(); }

  std::uint32_t vertex(std::uint32_t had, const Vec3f& normal) {
    constexpr float kSame = 1 - 1e-6f;
    for (const Made& each : made_)
      if (each.had == had && each.normal.dot(normal) > kSame) return each.vertex;
    std::uint32_t vertex = had;
    if (normals_[had].isZero()) {
      normals_[had] = normal;
    } else {
      vertex = static_cast<std::uint32_t>(mesh_.positions.size());
      mesh_.positions.push_back(Vec3f(mesh_.positions[had]));
      if (!mesh_.texcoords.empty()) mesh_.texcoords.push_back(Vec2f(mesh_.texcoords[had]));
      normals_.push_back(normal);
    }
    made_.push_back({had, vertex, normal});
    return vertex;
  }

  /// Vertices of no triangle look up.
  std::vector<Vec3f> normals() {
    for (Vec3f& n : normals_)
      if (n.isZero()) n = {0, 1, 0};
    return std::move(normals_);
  }

 private:
  struct Made {
    std::uint32_t had, vertex;
    Vec3f normal;
  };
  Mesh& mesh_;
  std::vector<Vec3f> normals_;
  std::vector<Made> made_;
};

}  // namespace

void smooth_with_creases(Mesh& mesh, double crease_degrees) {
  const Around around = corners_around(mesh);
  const auto least_cosine = static_cast<float>(std::cos(crease_degrees * kDegree));
  const std::size_t places = mesh.positions.size();
  Splitter splitter(mesh);
  std::vector<Facet> facets;
  for (std::size_t place = 0; place < places; ++place) {
    const std::size_t begin = around.first[place], end = around.first[place + 1];
    facets.clear();
    for (std::size_t k = begin; k < end; ++k) facets.push_back(facet_at(mesh, around.corners[k]));
    splitter.next_place();
    for (std::size_t k = begin; k < end; ++k) {
      const Facet& own = facets[k - begin];
      Vec3f sum = Vec3f::Zero();
      for (const Facet& other : facets)
        if (own.normal.dot(other.normal) >= least_cosine) sum += other.angle * other.normal;
      const Vec3f normal = sum.norm() > 1e-12f ? Vec3f(sum.normalized()) : own.normal;
      std::uint32_t& index = mesh.indices[around.corners[k]];
      index = splitter.vertex(index, normal);
    }
  }
  mesh.normals = splitter.normals();
}

}  // namespace hdr
