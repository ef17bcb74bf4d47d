#pragma once
// What occluders take from the irradiance of a point, and how that changes near by: the points of an irradiance cache.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"
#include "libhdr/render/tracer.h"

namespace hdr {

/// Near a point, with normals near its own: loss + by_rotation . (normal x n) + by_translation . (p - position).
struct IrradianceRecord {
  Vec3f position, normal;
  Rgbf loss;                                    ///< irradiance of the unoccluded sky less what arrives
  Eigen::Matrix3f by_rotation, by_translation;  ///< a row a channel
  Eigen::Matrix3f metric;                       ///< d^T metric d < 1 within the record's reach
  float trusted = 1;                            ///< share of the gradient of translation that may be used
  float doubt = 0;                              ///< luminance that it may be off by where its reach ends
  float radius = 0;                             ///< of a sphere that holds it
};

/// Where a record is asked for, and how fine the picture is there.
struct RecordPlace {
  Vec3f position, normal;
  float footprint;   ///< width of a pixel
  float irradiance;  ///< luminance, where nothing occludes
};

/// What leaves surfaces that rays met, towards where the rays began.
class ReflectedLight {
 public:
  virtual ~ReflectedLight() = default;
  /// `hits`: of a record's cells. Fills `rgb`, of as many.
  virtual void leaving(const std::vector<std::optional<Hit>>& hits, const std::vector<Vec3f>& towards,
                       std::uint64_t stream, std::vector<Rgbf>& rgb, std::int64_t& rays) const = 0;
};

class RecordMaker {
 public:
  /// `soft` is a lat-long without compact lights. `reflected`: null where occluders are black. All outlive the maker.
  RecordMaker(const Tracer& tracer, View<const float> soft, const ReflectedLight* reflected)
      : tracer_(tracer), soft_(soft), reflected_(reflected) {}

  /// From about `directions` rays. A point's loss has no bias.
  IrradianceRecord record(const RecordPlace& at, int directions, std::uint64_t stream, std::int64_t& rays) const;

  /// Its loss and gradients anew, from other rays; its reach stays. What decides how far a record reaches must not
  /// decide what it says as well: of two, the one that has missed an occluder by chance would speak for more.
  void say_again(IrradianceRecord& record, int directions, std::uint64_t stream, std::int64_t& rays) const;

 private:
  struct Cells;
  void trace(const RecordPlace& at, std::uint64_t stream, Cells& cells, std::int64_t& rays) const;
  static void integrate(const Cells& cells, IrradianceRecord& record);
  static Mat3 differentiate(const Cells& cells, IrradianceRecord& record);
  static void limit_gradient(const Cells& cells, IrradianceRecord& record);
  static void reach(const RecordPlace& at, const Cells& cells, const Mat3& hessian, IrradianceRecord& record);

  const Tracer& tracer_;
  View<const float> soft_;
  const ReflectedLight* reflected_;
};

}  // namespace hdr
