#include "libhdr/light/restore_clipped.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/components.h"

namespace hdr {
namespace {

using Regions = std::vector<std::vector<std::int32_t>>;

Rgb pixel_irradiance(View<const float> map, int x, int y, const Vec3& normal) {
  const double cosine = normal.dot(dir_from_latlong((x + 0.5) / map.width(), (y + 0.5) / map.height()));
  const float* p = map.pixel(x, y);
  return std::max(0.0, cosine) * latlong_pixel_solid_angle(y, map.width(), map.height()) * Rgb(p[0], p[1], p[2]);
}

// A row a measurement, a column a region, and a last one for all that is not clipped.
std::vector<std::vector<Rgb>> contributions(View<const float> map, const Regions& regions,
                                            const std::vector<MeasuredIrradiance>& measured) {
  std::vector<std::vector<Rgb>> table;
  for (const MeasuredIrradiance& m : measured) {
    const Vec3 normal = m.normal.normalized();
    std::vector<Rgb> row(regions.size() + 1, Rgb::Zero());
    for (int y = 0; y < map.height(); ++y)
      for (int x = 0; x < map.width(); ++x) row.back() += pixel_irradiance(map, x, y, normal);
    for (std::size_t k = 0; k < regions.size(); ++k) {
      for (const std::int32_t cell : regions[k])
        row[k] += pixel_irradiance(map, cell % map.width(), cell / map.width(), normal);
      row.back() -= row[k];
    }
    table.push_back(std::move(row));
  }
  return table;
}

// Least squares with gains >= 1, one channel, by cyclic minimisation: each gain in turn takes its best value with the
// others held, which for a convex quadratic converges to the constrained minimum. A little pull towards the common gain
// decides where the readings do not.
std::vector<double> fit(const std::vector<std::vector<Rgb>>& table, const std::vector<MeasuredIrradiance>& measured,
                        int channel) {
  const std::size_t regions = table[0].size() - 1;
  const auto row_scale = [&](std::size_t i) { return 1 / std::max(1e-300, measured[i].irradiance[channel]); };
  const auto minimise = [&](const auto& slope, const auto& current, double gain) {
    double above = 0, below = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
      const double s = slope(i) * row_scale(i);
      const double off = (measured[i].irradiance[channel] - current(i)) * row_scale(i);
      above += s * off;
      below += s * s;
    }
    return below > 0 ? std::max(1.0, gain + above / below) : gain;
  };
  std::vector<double> gains(regions, 1.0);
  const auto total = [&](std::size_t i) {
    double sum = table[i].back()[channel];
    for (std::size_t k = 0; k < regions; ++k) sum += gains[k] * table[i][k][channel];
    return sum;
  };
  // All regions by one number first: the start that fewer readings than regions do not leave.
  const auto all = [&](std::size_t i) { return total(i) - table[i].back()[channel]; };
  const double common = minimise(all, total, 1);
  std::fill(gains.begin(), gains.end(), common);
  if (table.size() < 2) return gains;
  for (int round = 0; round < 2000; ++round) {
    double moved = 0;
    for (std::size_t k = 0; k < regions; ++k) {
      const double before = gains[k];
      gains[k] = minimise([&](std::size_t i) { return table[i][k][channel]; }, total, gains[k]);
      moved = std::max(moved, std::abs(gains[k] - before) / before);
    }
    if (moved < 1e-10) break;
  }
  return gains;
}

}  // namespace

Image<std::uint8_t> clipped_mask(View<const float> latlong, double level) {
  HDR_ASSERT(latlong.channels() == 3);
  double limit = level;
  if (!(level > 0)) {
    for (int y = 0; y < latlong.height(); ++y)
      limit = std::max<double>(limit, *std::max_element(latlong.row(y), latlong.row(y) + 3 * latlong.width()));
    limit *= 0.98;
  }
  Image<std::uint8_t> mask(latlong.size(), 1);
  for (int y = 0; y < latlong.height(); ++y) {
    for (int x = 0; x < latlong.width(); ++x) {
      const float* p = latlong.pixel(x, y);
      mask(x, y) = limit > 0 && std::max({p[0], p[1], p[2]}) >= limit;
    }
  }
  return mask;
}

Restored restore_clipped(View<const float> latlong, View<const std::uint8_t> clipped,
                         const std::vector<MeasuredIrradiance>& measured) {
  HDR_ASSERT(latlong.channels() == 3 && clipped.size() == latlong.size());
  if (measured.empty()) throw Error("no irradiance was measured; give a lux meter's reading or normals of a ball");
  std::vector<std::uint8_t> inside;
  for (int y = 0; y < clipped.height(); ++y)
    inside.insert(inside.end(), clipped.row(y), clipped.row(y) + clipped.width());
  const Regions regions = connected_components(inside, clipped.size());
  if (regions.empty()) throw Error("nothing in the map is clipped; lower the level from which pixels count as clipped");
  const auto table = contributions(latlong, regions, measured);

  Restored result;
  result.regions = static_cast<int>(regions.size());
  result.gains.assign(regions.size(), Rgb::Ones());
  for (int c = 0; c < 3; ++c) {
    const std::vector<double> gains = fit(table, measured, c);
    double squares = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
      double sum = table[i].back()[c];
      for (std::size_t k = 0; k < regions.size(); ++k) sum += gains[k] * table[i][k][c];
      squares += std::pow((measured[i].irradiance[c] - sum) / std::max(1e-300, measured[i].irradiance[c]), 2);
    }
    result.residual[c] = std::sqrt(squares / static_cast<double>(table.size()));
    for (std::size_t k = 0; k < regions.size(); ++k) result.gains[k][c] = gains[k];
  }
  result.rgb = Image<float>(latlong.size(), 3);
  for (int y = 0; y < latlong.height(); ++y) std::copy_n(latlong.row(y), 3 * latlong.width(), result.rgb.row(y));
  for (std::size_t k = 0; k < regions.size(); ++k) {
    for (const std::int32_t cell : regions[k]) {
      float* p = result.rgb.pixel(cell % latlong.width(), cell / latlong.width());
      for (int c = 0; c < 3; ++c) p[c] = static_cast<float>(p[c] * result.gains[k][c]);
    }
  }
  return result;
}

}  // namespace hdr
