#pragma once
// Light that reaches surfaces by way of others. What is met on the way reflects diffusely, whatever its material.
#include <array>
#include <memory>
#include <vector>

#include "libhdr/render/internal/direction_pool.h"
#include "libhdr/render/internal/integrator.h"
#include "libhdr/render/internal/irradiance_record.h"

namespace hdr {

class Interreflection : public ReflectedLight {
 public:
  /// `bounces` of the options: how many surfaces light may go by; at least 1.
  explicit Interreflection(const Setting& setting);

  void begin(const Pass& pass);

  /// Adds to `out`, at each diffuse surface, what comes from other surfaces; as Integrator::irradiance().
  void irradiance(const Surfaces& at, const Pass& pass, Light& out, std::int64_t& rays) const;

  void leaving(const std::vector<std::optional<Hit>>& hits, const std::vector<Vec3f>& towards, std::uint64_t stream,
               std::vector<Rgbf>& rgb, std::int64_t& rays) const override;

 private:
  static constexpr int kRows = 16;  ///< that are traced together: of each place so many rays, each with its own light
  static constexpr int kSets = 8;   ///< of directions; rows beyond use them again, with other variants

  /// Of the surfaces that are met after `depth` others.
  struct Level {
    DirectionPool onward;                ///< directions that lead there
    std::unique_ptr<Integrator> direct;  ///< light that reaches them straight from the probe
  };
  using Set = std::vector<Level>;

  /// Which camera ray of `from` each row starts at.
  using Starts = std::array<int, kRows>;
  void meet(const Surfaces& from, const Starts& starts, int rows, const DirectionPool& pool, std::uint32_t tile,
            Surfaces& to, std::int64_t& rays) const;
  void light(const Surfaces& at, const Set& set, std::size_t depth, Light& out, std::int64_t& rays) const;

  const Setting& setting_;
  Pass own_;
  std::array<Set, kSets> sets_;
};

}  // namespace hdr
