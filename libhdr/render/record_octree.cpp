#include "libhdr/render/internal/record_octree.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"

namespace hdr {
namespace {

Vec3f corner(int octant, float by) {
  return {octant & 1 ? by : -by, octant & 2 ? by : -by, octant & 4 ? by : -by};
}

float brightness(const Rgbf& rgb) {
  return luminance(rgb[0], rgb[1], rgb[2]);
}

// Square of how far off a place is: 0 at the record itself, 1 and more where it does not reach.
float off2_of(const IrradianceRecord& record, const Vec3f& position, const Vec3f& normal) {
  constexpr float kWidestCosine = 0.94f;  // 20 degrees between normals
  const float cosine = record.normal.dot(normal);
  if (cosine <= kWidestCosine) return 1;
  const Vec3f away = position - record.position;
  const float distance2 = away.dot(record.metric * away);
  if (distance2 >= 1) return 1;
  // What lies behind the record sees what the record does not [Ward88].
  constexpr float kBehind = 0.05f;
  if (away.dot(record.normal + normal) < -2 * kBehind * record.radius) return 1;
  return distance2 + std::max(0.0f, 1 - cosine) / (1 - kWidestCosine);
}

// 0 at the border of the record's reach, 1 at the record itself.
float weight_of(float off2) {
  const float near = 1 - std::sqrt(off2);
  return near * near;
}

Rgbf said_by(const IrradianceRecord& record, const Vec3f& position, const Vec3f& normal, const Rgbf& sky) {
  const Vec3f said = record.loss.matrix() + record.by_rotation * record.normal.cross(normal) +
                     record.by_translation * (position - record.position);
  return said.array().max(-sky).min(sky);
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
      if (!visit(record, records_[record])) return;
    const int octant =
        (position.x() > centre.x() ? 1 : 0) | (position.y() > centre.y() ? 2 : 0) | (position.z() > centre.z() ? 4 : 0);
    half /= 2;
    centre += corner(octant, half);
    node = here.children[static_cast<std::size_t>(octant)];
  }
}

std::optional<RecordOctree::Said> RecordOctree::loss(const Vec3f& position, const Vec3f& normal,
                                                     const Rgbf& sky) const {
  Rgbf sum = Rgbf::Zero();
  float weights = 0, doubts = 0;
  at(position, [&](std::uint32_t, const IrradianceRecord& record) {
    const float off2 = off2_of(record, position, normal);
    if (off2 >= 1) return true;
    const float weight = weight_of(off2);
    sum += weight * said_by(record, position, normal, sky);
    // Neighbours err alike where what they tell of bends: their doubts do not cancel.
    doubts += weight * record.doubt * off2;
    weights += weight;
    return true;
  });
  if (weights <= 0) return std::nullopt;
  return Said{sum / weights, doubts / weights};
}

void RecordOctree::doubt(const std::vector<Rgbf>& sky) {
  struct Sums {
    double squares = 0, powers = 0;  ///< of how far off, as a share of what arrives; of (distance / reach)^4
  };
  std::vector<Sums> sums(records_.size());
  std::vector<float> foretold;
  const auto arriving = [&](std::size_t k) {
    return std::max(brightness(sky[k] - records_[k].loss), 1e-3f * brightness(sky[k]));
  };
  for (std::uint32_t k = 0; k < records_.size(); ++k) {
    const IrradianceRecord& asked = records_[k];
    at(asked.position, [&](std::uint32_t other, const IrradianceRecord& record) {
      const float off2 = other == k ? 1 : off2_of(record, asked.position, asked.normal);
      if (off2 >= 1) return true;
      const float off = brightness(said_by(record, asked.position, asked.normal, sky[k]) - asked.loss);
      const float before = foretold.size() < foretold_.size() ? foretold_[foretold.size()] : off;
      const float level = arriving(other);
      sums[other].squares += static_cast<double>(off * before / (level * level));
      sums[other].powers += static_cast<double>(off2 * off2);
      foretold.push_back(off);
      return true;
    });
  }
  foretold_ = std::move(foretold);
  Sums all;
  for (const Sums& one : sums) all.squares += one.squares, all.powers += one.powers;
  // Few have met a record: each has the word of all as one of its own.
  const double of_all = all.powers > 0 ? std::max(0.0, all.squares / all.powers) : 0;
  for (std::size_t k = 0; k < records_.size(); ++k) {
    const double own = (sums[k].squares + of_all) / (sums[k].powers + 1);
    records_[k].doubt = arriving(k) * static_cast<float>(std::sqrt(std::max(0.0, own)));
  }
}

bool RecordOctree::covered(const Vec3f& position, const Vec3f& normal) const {
  bool found = false;
  at(position, [&](std::uint32_t, const IrradianceRecord& record) {
    found = off2_of(record, position, normal) < 1;
    return !found;
  });
  return found;
}

}  // namespace hdr
