#pragma once
// A probe made ready for real-time engines: blurred for a row of roughnesses, and the table that goes with it.
#include <array>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// kGgx: the split sum's first half [Karis13]: the probe averaged over reflections of a GGX surface seen head-on,
/// weighted by n.l, alpha = roughness^2. kPhong: averaged over cos^s around the reflected direction [Miller84], with
/// s = 2 / alpha^2 - 2. Both are means: a constant probe stays what it is.
enum class Lobe { kGgx, kPhong };

/// Looks up what a lobe around a direction sees, by filtered importance sampling [Krivanek08]: each of `samples`
/// directions reads the probe blurred to the solid angle that it stands for.
class Prefilter {
 public:
  /// A lat-long with three channels, finite and non-negative.
  explicit Prefilter(View<const float> latlong);

  /// Roughness 0 is the mirror: the probe between its pixel centres.
  Rgb mean(const Vec3& dir, double roughness, Lobe lobe = Lobe::kGgx, int samples = 512) const;

  /// The map at `size`, a lat-long, for one roughness. The mirror's pixels are means over what they cover.
  Image<float> latlong(Size size, double roughness, Lobe lobe = Lobe::kGgx, int samples = 512) const;
  /// The same on the six faces of a cube (cube.h); the mirror's are samples at pixel centres of a level as fine.
  std::array<Image<float>, 6> cube(int width, double roughness, Lobe lobe = Lobe::kGgx, int samples = 512) const;

 private:
  struct Sample {
    Vec3 dir;  ///< around +Z
    double weight, solid_angle;
  };
  std::vector<Sample> samples_of(double roughness, Lobe lobe, int count) const;
  Rgb mean_of(const Vec3& dir, const std::vector<Sample>& samples) const;
  Rgb blurred(const Vec3& dir, double solid_angle) const;
  Rgb bilinear(const Vec3& dir, std::size_t level) const;

  std::vector<Image<float>> levels_;  ///< each half as large, means by solid angle
};

/// The split sum's second half: a GGX surface seen at n.v = cos_v (> 0) returns F0 scale + bias of a constant probe, F0
/// its colour at normal incidence; Schlick's Fresnel, Smith's shadowing with correlated heights, one bounce. Within
/// 2e-5 by quadrature; roughness 0 is the mirror, exactly.
struct SplitSum {
  double scale = 0, bias = 0;
};
SplitSum split_sum(double cos_v, double roughness);

/// Scale (first channel) and bias (second). Column x: n.v = (x + 0.5) / size; row y: roughness = (y + 0.5) / size.
Image<float> split_sum_table(int size);

}  // namespace hdr
