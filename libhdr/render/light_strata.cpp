#include "libhdr/render/internal/light_strata.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/lights.h"

namespace hdr {
namespace {

constexpr int kWidestCells = 1024;  // as light_cells() cuts maps: strata of make_lights() are of the same cells

double luminance_of(const float* p) {
  return luminance<double>(p[0], p[1], p[2]);
}

}  // namespace

LightStrata::LightStrata(View<const float> latlong)
    : map_(latlong), block_((latlong.width() + kWidestCells - 1) / kWidestCells) {
  HDR_ASSERT(latlong.channels() == 3 && !latlong.empty());
  cells_ = {(latlong.width() + block_ - 1) / block_, (latlong.height() + block_ - 1) / block_};
  luminances_.assign(static_cast<std::size_t>(cells_.width) * static_cast<std::size_t>(cells_.height), 0.0);
  for_rows(cells_.height, 8, [&](int first, int last) {
    for (int cell_y = first; cell_y < last; ++cell_y) {
      double* row = luminances_.data() + static_cast<std::ptrdiff_t>(cell_y) * cells_.width;
      for (int y = cell_y * block_; y < std::min((cell_y + 1) * block_, map_.height()); ++y) {
        const double solid_angle = latlong_pixel_solid_angle(y, map_.width(), map_.height());
        for (int x = 0; x < map_.width(); ++x) row[x / block_] += solid_angle * luminance_of(map_.pixel(x, y));
      }
    }
  });
}

void LightStrata::append(std::int32_t cell) {
  const double light = luminances_[static_cast<std::size_t>(cell)];
  if (!(light > 0)) return;
  const std::size_t begin = ends_.empty() ? 0 : ends_.back();
  sums_.push_back((members_.size() > begin ? sums_.back() : 0) + light);
  members_.push_back(cell);
}

void LightStrata::end_stratum() {
  if (members_.size() > (ends_.empty() ? 0 : ends_.back())) ends_.push_back(members_.size());
}

LightStrata LightStrata::grid(View<const float> latlong, int count) {
  LightStrata strata(latlong);
  const int down = std::clamp(static_cast<int>(std::sqrt(count / 2.0)), 1, strata.cells_.height);
  const int across = std::clamp(count / down, 1, strata.cells_.width);
  const auto border = [](int k, int parts, int whole) { return static_cast<int>(std::int64_t{k} * whole / parts); };
  for (int j = 0; j < down; ++j) {
    for (int i = 0; i < across; ++i) {
      for (int y = border(j, down, strata.cells_.height); y < border(j + 1, down, strata.cells_.height); ++y)
        for (int x = border(i, across, strata.cells_.width); x < border(i + 1, across, strata.cells_.width); ++x)
          strata.append(y * strata.cells_.width + x);
      strata.end_stratum();
    }
  }
  return strata;
}

LightStrata LightStrata::structured(View<const float> latlong, int count) {
  const Lights lights = make_lights(latlong, {count, LightsMethod::kStructured, LightPlacement::kCentroid, 1});
  LightStrata strata(latlong);
  HDR_ASSERT(strata.cells_ == lights.strata.size());
  std::vector<std::vector<std::int32_t>> members(lights.lights.size());
  for (int y = 0; y < lights.strata.height(); ++y)
    for (int x = 0; x < lights.strata.width(); ++x)
      members[static_cast<std::size_t>(lights.strata(x, y))].push_back(y * lights.strata.width() + x);
  for (const auto& stratum : members) {
    for (const std::int32_t cell : stratum) strata.append(cell);
    strata.end_stratum();
  }
  return strata;
}

// Pixels of the cell in turn, by their luminance.
LightStrata::Pixel LightStrata::pixel_of(std::int32_t cell, double& u) const {
  const int left = cell % cells_.width * block_, top = cell / cells_.width * block_;
  if (block_ == 1) return {left, top};
  double rest = u * luminances_[static_cast<std::size_t>(cell)];
  Pixel last{left, top};
  for (int y = top; y < std::min(top + block_, map_.height()); ++y) {
    const double solid_angle = latlong_pixel_solid_angle(y, map_.width(), map_.height());
    for (int x = left; x < std::min(left + block_, map_.width()); ++x) {
      const double here = solid_angle * luminance_of(map_.pixel(x, y));
      if (!(here > 0)) continue;
      u = rest / here;
      if (rest < here) return {x, y};
      rest -= here;
      last = {x, y};
    }
  }
  return last;  // the sums' rounding
}

LightStrata::Sample LightStrata::sample(int stratum, const Vec2& u) const {
  const std::size_t begin = stratum == 0 ? 0 : ends_[static_cast<std::size_t>(stratum) - 1];
  const std::size_t end = ends_[static_cast<std::size_t>(stratum)];
  const double total = sums_[end - 1], wanted = u.x() * total;
  const auto found = std::upper_bound(sums_.begin() + static_cast<std::ptrdiff_t>(begin),
                                      sums_.begin() + static_cast<std::ptrdiff_t>(end) - 1, wanted);
  const auto index = static_cast<std::size_t>(found - sums_.begin());
  const double before = index == begin ? 0 : sums_[index - 1];
  double across = (wanted - before) / (sums_[index] - before);  // what is left of u
  const auto [x, y] = pixel_of(members_[index], across);
  across = std::clamp(across, 0.0, 1.0);
  // Uniform in solid angle inside the pixel.
  const double top = std::cos(kPi * y / map_.height()), bottom = std::cos(kPi * (y + 1) / map_.height());
  const double height = top + u.y() * (bottom - top), horizontal = std::sqrt(std::max(0.0, 1 - height * height));
  const double azimuth = 2 * kPi * (0.5 - (x + across) / map_.width());
  const float* p = map_.pixel(x, y);
  const double to_stratum = total / luminance_of(p);
  return {Vec3(horizontal * std::sin(azimuth), height, horizontal * std::cos(azimuth)).cast<float>(),
          (Rgb(p[0], p[1], p[2]) * to_stratum).cast<float>()};
}

}  // namespace hdr
