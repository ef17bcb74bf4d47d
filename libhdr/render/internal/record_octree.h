#pragma once
// Records of an irradiance cache by where they reach [Ward88].
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "libhdr/render/internal/irradiance_record.h"

namespace hdr {

class RecordOctree {
 public:
  /// Of a cube about `centre` that holds all places.
  RecordOctree(const Vec3f& centre, float half_side);

  void add(const IrradianceRecord& record);
  std::size_t size() const { return records_.size(); }
  const std::vector<IrradianceRecord>& records() const { return records_; }
  /// To change what they say; where they are and how far they reach must stay.
  std::vector<IrradianceRecord>& records() { return records_; }

  /// What occluders take at a place: the mean of what the records say that reach it, by how near they are; none do:
  /// nothing. No record may say more than `sky`, what there is to take.
  std::optional<Rgbf> loss(const Vec3f& position, const Vec3f& normal, const Rgbf& sky) const;
  bool covered(const Vec3f& position, const Vec3f& normal) const;

 private:
  struct Node {
    std::array<std::int32_t, 8> children{-1, -1, -1, -1, -1, -1, -1, -1};
    std::vector<std::uint32_t> records;
  };
  static constexpr int kDeepest = 16;

  void add(std::size_t node, const Vec3f& centre, float half, int depth, std::uint32_t record);
  template <class Visit>
  void at(const Vec3f& position, const Visit& visit) const;

  Vec3f centre_;
  float half_;
  std::vector<Node> nodes_;
  std::vector<IrradianceRecord> records_;
};

}  // namespace hdr
