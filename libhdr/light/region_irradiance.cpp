// Over what a normal wholly faces, the integral of L (n.w) is n times the integral of L w: blocks of pixels keep that
// one matrix, and only those which the normal's horizon crosses are summed pixel by pixel.
#include "libhdr/light/internal/region_irradiance.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

struct Block {
  int x0, x1, y0, y1;
  Vec3 axis;
  double sine;           // of the largest angle between the axis and a pixel; 2: more than a quarter turn
  Eigen::Matrix3d flux;  // rows: channels, columns: x, y, z
};

class Blocks {
 public:
  Blocks(View<const float> map, const std::vector<std::uint8_t>& left_out) : map_(map), left_out_(left_out) {
    for (int y = 0; y < map.height(); ++y) {
      solid_angles_.push_back(latlong_pixel_solid_angle(y, map.width(), map.height()));
      const double polar = kPi * (y + 0.5) / map.height();
      polar_.emplace_back(std::sin(polar), std::cos(polar));
    }
    for (int x = 0; x < map.width(); ++x) azimuths_.push_back(dir_from_latlong((x + 0.5) / map.width(), 0.5));
    const int columns = std::min(128, map.width()), rows = std::min(64, map.height());
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i)
        blocks_.push_back({i * map.width() / columns, (i + 1) * map.width() / columns, j * map.height() / rows,
                           (j + 1) * map.height() / rows, Vec3::UnitY(), 2, Eigen::Matrix3d::Zero()});
    for_rows(static_cast<int>(blocks_.size()), 64, [&](int first, int last) {
      for (int k = first; k < last; ++k) fill(blocks_[static_cast<std::size_t>(k)]);
    });
  }

  Vec3 direction(int x, int y) const {
    const Vec3& horizon = azimuths_[static_cast<std::size_t>(x)];
    const Vec2& polar = polar_[static_cast<std::size_t>(y)];
    return {polar.x() * horizon.x(), polar.y(), polar.x() * horizon.z()};
  }

  /// Radiance times solid angle.
  Rgb light(int x, int y) const {
    const float* p = map_.pixel(x, y);
    return solid_angles_[static_cast<std::size_t>(y)] * Rgb(p[0], p[1], p[2]);
  }

  Rgb irradiance(const Vec3& normal) const {
    Rgb sum = Rgb::Zero();
    for (const Block& block : blocks_) {
      const double height = normal.dot(block.axis);
      if (height > block.sine) {
        sum += (block.flux * normal).array();
      } else if (height > -block.sine) {
        each(block, [&](const Vec3& dir, const Rgb& light) { sum += std::max(0.0, normal.dot(dir)) * light; });
      }
    }
    return sum;
  }

 private:
  template <class F>
  void each(const Block& block, const F& f) const {
    for (int y = block.y0; y < block.y1; ++y)
      for (int x = block.x0; x < block.x1; ++x)
        if (!left_out_[static_cast<std::size_t>(y) * static_cast<std::size_t>(map_.width()) +
                       static_cast<std::size_t>(x)])
          f(direction(x, y), light(x, y));
  }

  void fill(Block& block) const {
    Vec3 middle = Vec3::Zero();
    each(block, [&](const Vec3& dir, const Rgb& light) {
      middle += dir;
      block.flux += light.matrix() * dir.transpose();
    });
    if (!(middle.norm() > 0)) return;
    block.axis = middle.normalized();
    double cosine = 1;
    each(block, [&](const Vec3& dir, const Rgb&) { cosine = std::min(cosine, block.axis.dot(dir)); });
    if (cosine > 0) block.sine = std::sqrt(1 - cosine * cosine) + 1e-9;
  }

  View<const float> map_;
  const std::vector<std::uint8_t>& left_out_;
  std::vector<double> solid_angles_;
  std::vector<Vec2> polar_;     // sine and cosine of rows' polar angles
  std::vector<Vec3> azimuths_;  // columns' directions on the horizon
  std::vector<Block> blocks_;
};

}  // namespace

std::vector<std::vector<Rgb>> region_irradiance(View<const float> latlong, const std::vector<Region>& regions,
                                                const std::vector<Vec3>& normals) {
  std::vector<std::uint8_t> taken(static_cast<std::size_t>(latlong.width()) *
                                  static_cast<std::size_t>(latlong.height()));
  for (const Region& region : regions)
    for (const std::int32_t cell : region) taken[static_cast<std::size_t>(cell)] = 1;
  const Blocks others(latlong, taken);
  std::vector<std::vector<Rgb>> table(normals.size(), std::vector<Rgb>(regions.size() + 1, Rgb::Zero()));
  for_rows(static_cast<int>(normals.size()), 4, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const Vec3& normal = normals[static_cast<std::size_t>(i)];
      std::vector<Rgb>& row = table[static_cast<std::size_t>(i)];
      for (std::size_t k = 0; k < regions.size(); ++k) {
        for (const std::int32_t cell : regions[k]) {
          const int x = cell % latlong.width(), y = cell / latlong.width();
          const double cosine = normal.dot(others.direction(x, y));
          if (cosine > 0) row[k] += cosine * others.light(x, y);
        }
      }
      row.back() = others.irradiance(normal);
    }
  });
  return table;
}

}  // namespace hdr
