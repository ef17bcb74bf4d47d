// Irradiance from harmonics [Ramamoorthi01]: no shadows, no noise. Of degree 2, a quadratic form of the normal.
#include "libhdr/light/sh.h"

#include <algorithm>

#include "libhdr/render/internal/integrator.h"

namespace hdr {
namespace {

class ShIrradiance : public Integrator {
 public:
  explicit ShIrradiance(const Setting& setting) {
    const View<const float> map = setting.light.latlong();
    sh_ = project(map, LatLong{map.size()}, setting.sh_degree);
    const std::array<Mat4, 3> matrices = irradiance_matrices(sh_);
    for (std::size_t c = 0; c < 3; ++c) matrices_[c] = matrices[c].cast<float>();
  }

  void begin(const Pass&) override {}

  void irradiance(const Surfaces& at, const Pass&, Light& out, std::int64_t&) const override {
    if (sh_.degree > 2) return of_any_degree(at, out);
    for (std::size_t c = 0; c < 3; ++c) of_degree_two(at, matrices_[c], out.rgb[c]);
  }

  bool exact() const override { return true; }

 private:
  // Eq. 17 with its last row mended: E = (n,1)^T M (n,1).
  static void of_degree_two(const Surfaces& at, const Eigen::Matrix4f& m, std::vector<float>& out) {
    const float xx = m(0, 0), yy = m(1, 1), zz = m(2, 2), xy = 2 * m(0, 1), xz = 2 * m(0, 2), yz = 2 * m(1, 2),
                x1 = 2 * m(0, 3), y1 = 2 * m(1, 3), z1 = 2 * m(2, 3), one = m(3, 3);
    const float *nx = at.normal_x.data(), *ny = at.normal_y.data(), *nz = at.normal_z.data();
    float* to = out.data();
    for (int k = 0; k < at.count(); ++k) {
      const float x = nx[k], y = ny[k], z = nz[k];
      const float e = x * (xx * x + xy * y + xz * z + x1) + y * (yy * y + yz * z + y1) + z * (zz * z + z1) + one;
      to[k] += std::max(e, 0.0f);  // few coefficients of a sun ring below zero on the far side
    }
  }

  void of_any_degree(const Surfaces& at, Light& out) const {
    for (std::size_t k = 0; k < at.diffuse.size(); ++k) {
      if (!at.diffuse[k]) continue;
      const Vec3 normal(at.normal_x[k], at.normal_y[k], at.normal_z[k]);
      out.add(static_cast<int>(k), hdr::irradiance(sh_, normal).max(0.0).cast<float>());
    }
  }

  Sh sh_;
  std::array<Eigen::Matrix4f, 3> matrices_;
};

}  // namespace

std::unique_ptr<Integrator> make_sh(const Setting& setting) {
  return std::make_unique<ShIrradiance>(setting);
}

}  // namespace hdr
