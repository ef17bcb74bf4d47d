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

  struct Said {
    Rgbf loss;
    float doubt;  ///< luminance that `loss` may be off by, beside what the records' rays missed by chance
  };
  /// What occluders take at a place: the mean of what the records say that reach it, by how near they are; none do:
  /// nothing. No record may say more than `sky`, what there is to take.
  std::optional<Said> loss(const Vec3f& position, const Vec3f& normal, const Rgbf& sky) const;

  /// Each record is asked for by those that reach it, and what they say held against what it says itself: how far off a
  /// record is grows as the square of the distance, in units of its reach, which gives its doubt. `sky` is what there
  /// is to take by each record. Asked again after the records have said anew what they see, independently, the noise of
  /// both drops out of the products of the differences.
  void doubt(const std::vector<Rgbf>& sky);
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
  std::vector<float> foretold_;  ///< of each pair of records, one within the other's reach: how far off, last time
};

}  // namespace hdr
