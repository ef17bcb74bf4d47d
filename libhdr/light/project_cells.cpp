#include <algorithm>
#include <cmath>
#include <optional>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/project.h"
#include "libhdr/light/internal/quadrature.h"
#include "libhdr/light/internal/solid_angle.h"

namespace hdr {
namespace {

// A share of a pixel, in continuous pixel coordinates.
struct Cell {
  double x0, y0, x1, y1;
};

// Integrates the basis over cells. Near the rim of a disc directions turn quickly (a mirror ball squeezes half the
// world into its outer third), so cells there are split until they are small beside the disc; those that the rim
// crosses are cut exactly along it.
class CellIntegrator {
 public:
  CellIntegrator(const Projection& projection, int degree)
      : projection_(projection),
        degree_(degree),
        disc_(disc_of(projection)),
        rule_(gauss_legendre(nodes(projection, degree))),
        basis_(static_cast<std::size_t>(sh_count(degree))) {}

  /// total[k] += integral over the cell of Y_k.
  void add(const Cell& cell, std::vector<double>& total) {
    if (!disc_) return add_whole(cell, total);
    const double size = cell.x1 - cell.x0;
    const double nearest = std::hypot(std::max({cell.x0 - disc_->cx, disc_->cx - cell.x1, 0.0}),
                                      std::max({cell.y0 - disc_->cy, disc_->cy - cell.y1, 0.0}));
    const double farthest = std::hypot(std::max(disc_->cx - cell.x0, cell.x1 - disc_->cx),
                                       std::max(disc_->cy - cell.y0, cell.y1 - disc_->cy));
    if (nearest >= disc_->r) return;
    if (farthest < disc_->r - 3 * size) return add_whole(cell, total);
    if (size > disc_->r * kSmallest) return add_quarters(cell, total);
    if (farthest <= disc_->r) return add_whole(cell, total);
    add_cut(cell, total);
  }

 private:
  static constexpr double kSmallest = 1.0 / 128;  ///< of the disc's radius

  // Degree + 1 radians of phase for each radian of direction; a pixel in the middle spans `angle` of those.
  static int nodes(const Projection& projection, int degree) {
    const double angle = std::sqrt(solid_angle_in_middle(projection));
    const double phase = (degree + 1) * angle;
    constexpr double kTwoNodesDo = 0.2;  // a wave's cell mean is then wrong by phase^4 / 4320, under 4e-7
    return phase < kTwoNodesDo ? 2 : 3 + static_cast<int>(std::ceil(0.5 * phase));
  }

  void add_point(const Vec2& px, double weight, std::vector<double>& total) {
    const std::optional<Vec3> dir = dir_from_px(projection_, px);
    if (!dir) return;
    sh_basis(*dir, degree_, basis_.data());
    weight *= solid_angle_density(projection_, px);
    for (std::size_t k = 0; k < total.size(); ++k) total[k] += weight * basis_[k];
  }

  void add_whole(const Cell& cell, std::vector<double>& total) {
    const double width = cell.x1 - cell.x0, height = cell.y1 - cell.y0;
    for (std::size_t j = 0; j < rule_.nodes.size(); ++j) {
      for (std::size_t i = 0; i < rule_.nodes.size(); ++i) {
        const Vec2 px(cell.x0 + width * rule_.nodes[i], cell.y0 + height * rule_.nodes[j]);
        add_point(px, width * height * rule_.weights[i] * rule_.weights[j], total);
      }
    }
  }

  void add_quarters(const Cell& cell, std::vector<double>& total) {
    const double mx = 0.5 * (cell.x0 + cell.x1), my = 0.5 * (cell.y0 + cell.y1);
    add({cell.x0, cell.y0, mx, my}, total);
    add({mx, cell.y0, cell.x1, my}, total);
    add({cell.x0, my, mx, cell.y1}, total);
    add({mx, my, cell.x1, cell.y1}, total);
  }

  // Strips across the rim, along the axis in which the rim is steeper. The angle to the rim goes with the square root
  // of the distance to it, so nodes are placed by the square: px = rim -+ length t^2.
  void add_cut(const Cell& cell, std::vector<double>& total) {
    const double dx = 0.5 * (cell.x0 + cell.x1) - disc_->cx, dy = 0.5 * (cell.y0 + cell.y1) - disc_->cy;
    const bool along_x = std::abs(dx) >= std::abs(dy);
    const double side = (along_x ? dx : dy) < 0 ? -1 : 1;
    const double across0 = along_x ? cell.y0 : cell.x0, across1 = along_x ? cell.y1 : cell.x1;
    const double along_centre = along_x ? disc_->cx : disc_->cy, across_centre = along_x ? disc_->cy : disc_->cx;
    // Distances from the centre's line outwards.
    const double a = side * ((along_x ? cell.x0 : cell.y0) - along_centre);
    const double b = side * ((along_x ? cell.x1 : cell.y1) - along_centre);
    const double inner = std::min(a, b), outer = std::max(a, b);
    for (std::size_t j = 0; j < rule_.nodes.size(); ++j) {
      const double across = across0 + (across1 - across0) * rule_.nodes[j];
      const double offset = across - across_centre;
      const double rim = std::sqrt(std::max(0.0, disc_->r * disc_->r - offset * offset));
      const double end = std::min(rim, outer);
      if (end <= inner) continue;
      for (std::size_t i = 0; i < rule_.nodes.size(); ++i) {
        const double t = rule_.nodes[i];
        const double along = along_centre + side * (end - (end - inner) * t * t);
        const double weight = (across1 - across0) * rule_.weights[j] * (end - inner) * 2 * t * rule_.weights[i];
        add_point(along_x ? Vec2(along, across) : Vec2(across, along), weight, total);
      }
    }
  }

  const Projection& projection_;
  int degree_;
  std::optional<Disc> disc_;
  GaussRule rule_;
  std::vector<double> basis_;
};

}  // namespace

Sh project_cells(View<const float> rgb, const Projection& projection, int degree) {
  const std::vector<Rgb> zero(static_cast<std::size_t>(sh_count(degree)), Rgb::Zero());
  constexpr int kRowsInBlock = 8;
  std::vector<Rgb> sum = reduce_rows(
      rgb.height(), kRowsInBlock, zero,
      [&](int first, int last) {
        CellIntegrator integrator(projection, degree);
        std::vector<Rgb> part = zero;
        std::vector<double> cell(zero.size());
        for (int y = first; y < last; ++y) {
          for (int x = 0; x < rgb.width(); ++x) {
            const float* p = rgb.pixel(x, y);
            if (p[0] == 0 && p[1] == 0 && p[2] == 0) continue;
            std::fill(cell.begin(), cell.end(), 0.0);
            integrator.add({1.0 * x, 1.0 * y, x + 1.0, y + 1.0}, cell);
            const Rgb radiance(p[0], p[1], p[2]);
            for (std::size_t k = 0; k < cell.size(); ++k) part[k] += cell[k] * radiance;
          }
        }
        return part;
      },
      [](std::vector<Rgb>& total, const std::vector<Rgb>& part) {
        for (std::size_t k = 0; k < total.size(); ++k) total[k] += part[k];
      });
  return {degree, std::move(sum)};
}

Sh project(View<const float> rgb, const Projection& projection, int degree) {
  HDR_ASSERT(rgb.channels() == 3 && !rgb.empty());
  HDR_ASSERT(degree >= 0 && degree <= kMaxShDegree);
  if (is_plain_latlong(projection)) return project_latlong(rgb, degree);
  return project_cells(rgb, projection, degree);
}

}  // namespace hdr
