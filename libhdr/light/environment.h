#pragma once
// A probe as a light: radiance(dir), sample(u) -> dir, pdf(dir), and invert(dir) -> u, the inverse of sample.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "libhdr/core/color.h"
#include "libhdr/core/image.h"
#include "libhdr/core/radiance.h"
#include "libhdr/core/vec.h"
#include "libhdr/light/block_alias.h"
#include "libhdr/light/block_distribution.h"
#include "libhdr/light/step_distribution.h"
#include "libhdr/probe/projection.h"

namespace hdr {

/// A probe of any projection as a lat-long of `width` (0: as fine as the source's middle, at most 16384; a lat-long as
/// it is), what the probe does not show being black.
Image<float> latlong_from_probe(const RadianceMap& probe, const Projection& projection, int width = 0);

/// Importance sampling of a lat-long whose pixels are constants, by luminance times solid angle: row marginal, then
/// column conditional, sums in double; uniform in solid angle inside the pixel, so that pdf = luminance / total
/// exactly. An all-black map samples the sphere uniformly. A black pixel is never drawn, and every other pixel can be,
/// as far down as the 53 bits of each component of u tell shares apart.
class Environment {
 public:
  /// kCompensated, for multiple importance sampling with a surface's own directions [Karlik19]: by what a pixel has
  /// above the mean luminance of the sphere. Pixels below it have density 0 and are left to the other sampler, which
  /// must reach them. A map without anything above its mean is sampled as it is.
  enum class Density { kLuminance, kCompensated };

  /// How the column is found. kInOrder inverts running sums: points that are spread evenly stay so on the sphere.
  /// kAlias looks into alias tables: for independent numbers, from maps that no cache holds.
  enum class Order { kInOrder, kAlias };

  /// A lat-long with three channels, finite and non-negative (read_map has seen to it). Values up to 1e30 are no
  /// trouble: sums are in double.
  explicit Environment(Image<float> latlong, Density density = Density::kLuminance, Order order = Order::kInOrder);

  /// Of latlong_from_probe().
  static Environment from_probe(const RadianceMap& probe, const Projection& projection, int width = 0,
                                Density density = Density::kLuminance);

  struct Sample {
    Vec3f dir;
    Rgbf radiance;
    float pdf;  ///< per steradian
  };

  Sample sample(const Vec2& u) const;  ///< u in [0,1)^2
  /// The same samples, many at once: from a map that no cache holds, 1.7 times as fast (8192 wide), as memory is waited
  /// for together. As many `samples` as `u`.
  void sample(std::span<const Vec2> u, std::span<Sample> samples) const;
  Sample lookup(const Vec3f& dir) const;  ///< the pixel that a direction meets, and its pdf
  Rgbf radiance(const Vec3f& dir) const { return lookup(dir).radiance; }
  /// Between pixel centres, for what is looked at (backdrops, mirrors); light is computed from the pixels as they are.
  Rgbf smooth_radiance(const Vec3f& dir) const;
  float pdf(const Vec3f& dir) const { return lookup(dir).pdf; }
  float pdf_of_pixel(int x, int y) const;
  /// The density of a pixel from its radiance alone, for many look-ups.
  struct DensityLaw {
    float uniform, floor, per_luminance;
    float pdf(const float* rgb) const {
      return uniform + per_luminance * std::max(0.0f, luminance(rgb[0], rgb[1], rgb[2]) - floor);
    }
  };
  DensityLaw density_law() const;
  /// A u with sample(u).dir = dir (of kInOrder the only one); where pdf(dir) is 0, the nearest u there is.
  Vec2 invert(const Vec3f& dir) const;

  View<const float> latlong() const { return map_; }
  bool black() const { return total_ == 0; }
  Rgb total_power() const { return power_; }  ///< integral of L over the sphere, per channel

 private:
  void weigh(double floor);
  template <class Columns>
  void weigh(Columns& columns, double floor);
  template <class Columns>
  void sample_many(const Columns& columns, std::span<const Vec2> u, std::span<Sample> samples) const;
  float pdf_of_weight(double weight) const;
  double weight(int x, int y) const { return order_ == Order::kAlias ? aliases_.weight(x, y) : columns_.weight(x, y); }
  Sample sample_at(const StepDistribution::Step& row, const BlockDistribution::Place& column) const;
  Sample sample_of(const Vec3f& dir, int x, int y, double weight) const;

  Image<float> map_;
  Order order_;
  double per_width_;
  StepDistribution rows_;             ///< by weight times solid angle
  BlockDistribution columns_;         ///< of each row, by weight: its view is of map_, whose pixels do not move with it
  BlockAlias aliases_;                ///< instead of it
  std::vector<double> shares_above_;  ///< of the sphere, above each row
  double total_ = 0;                  ///< integral of the weight
  double per_total_ = 0;              ///< 1 / total_
  double floor_ = 0;                  ///< luminance that counts as 0
  Rgb power_ = Rgb::Zero();
};

}  // namespace hdr
