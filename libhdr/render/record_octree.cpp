#include "libhdr/render/internal/record_octree.h"

namespace hdr {
namespace {

Vec3f corner(int octant, float by) {
  return {octant & 1 ? by : -by, octant & 2 ? by : -by, octant & 4 ? by : -by};
}

// 0 at the border of the record's reach and beyond, 1 at the record itself.
float weight_of(const IrradianceRecord& record, const Vec3f& position, const Vec3f& normal) {
  constexpr float kWidestCosine = 0.94f;  // 20 degrees between normals
  const float cosine = record.normal.dot(normal);
  if (cosine <= kWidestCosine) return 0;
  const Vec3f away = position - record.position;
  const float distance2 = away.dot(record.metric * away);
  if (distance2 >= 1) return 0;
  // What lies behind the record sees what the record does not [Ward88].
  constexpr float kBehind = 0.05f;
  if (away.dot(record.normal + normal) < -2 * kBehind * record.radius) return 0;
  const float turned2 = (1 - cosine) / (1 - kWidestCosine);
  const float off2 = distance2 + turned2;
  if (off2 >= 1) return 0;
  const float near = 1 - std::sqrt(off2);
  return near * near;
}

}  // namespace

RecordOctree::RecordOctree(const Vec3f& centre, float half_side) : centre_(centre), half_(half_side), nodes_(1) {}

void RecordOctree::add(const IrradianceRecord& record) {
  records_.push_back(record);
  add(0, centre_, half_, 0, static_cast<std::uint32_t>(records_.size() - 1));
}

// Into nodes that are half as large as the record's reach or less: places are asked for far more often than records are
// added, and few records of such a node do not reach a place in it.
void RecordOctree::add(std::size_t node, const Vec3f& centre, float half, int depth, std::uint32_t record) {
  const IrradianceRecord& what = records_[record];
  if (depth == kDeepest || half < 0.5f * what.radius) {
    nodes_[node].records.push_back(record);
    return;
  }
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3f middle = centre + corner(octant, half / 2);
    if (((what.position - middle).cwiseAbs().array() > half / 2 + what.radius).any()) continue;
    std::int32_t child = nodes_[node].children[static_cast<std::size_t>(octant)];
    if (child < 0) {
      child = static_cast<std::int32_t>(nodes_.size());
      nodes_[node].children[static_cast<std::size_t>(octant)] = child;
      nodes_.emplace_back();
    }
    add(static_cast<std::size_t>(child), middle, half / 2, depth + 1, record);
  }
}

template <class Visit>
void RecordOctree::at(const Vec3f& position, const Visit& visit) const {
  Vec3f centre = centre_;
  float half = half_;
  for (std::int32_t node = 0; node >= 0;) {
    const Node& here = nodes_[static_cast<std::size_t>(node)];
    for (const std::uint32_t record : here.records)
      if (!visit(records_[record])) return;
    const int octant =
        (position.x() > centre.x() ? 1 : 0) | (position.y() > centre.y() ? 2 : 0) | (position.z() > centre.z() ? 4 : 0);
    half /= 2;
    centre += corner(octant, half);
    node = here.children[static_cast<std::size_t>(octant)];
  }
}

std::optional<Rgbf> RecordOctree::loss(const Vec3f& position, const Vec3f& normal, const Rgbf& sky) const {
  Rgbf sum = Rgbf::Zero();
  float weights = 0;
  at(position, [&](const IrradianceRecord& record) {
    const float weight = weight_of(record, position, normal);
    if (weight <= 0) return true;
    const Vec3f said = record.loss.matrix() + record.by_rotation * record.normal.cross(normal) +
                       record.by_translation * (position - record.position);
    sum += weight * said.array().max(-sky).min(sky);
    weights += weight;
    return true;
  });
  if (weights <= 0) return std::nullopt;
  return sum / weights;
}

bool RecordOctree::covered(const Vec3f& position, const Vec3f& normal) const {
  bool found = false;
  at(position, [&](const IrradianceRecord& record) {
    found = weight_of(record, position, normal) > 0;
    return !found;
  });
  return found;
}

}  // namespace hdr
