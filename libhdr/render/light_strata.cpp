#include "libhdr/render/internal/light_strata.h"

#include <algorithm>
#include <cmath>
#include <queue>

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

// A rectangle of cells, its luminance and solid angle.
struct Rectangle {
  int left, top, right, bottom;
  double light, solid_angle, importance;
  bool operator<(const Rectangle& other) const { return importance < other.importance; }
};

// Sums over rectangles from sums over those that begin at the corner.
class Table {
 public:
  Table(const std::vector<double>& cells, Size size) : size_(size), width_(static_cast<std::size_t>(size.width) + 1) {
    sums_.assign(width_ * (static_cast<std::size_t>(size.height) + 1), 0.0);
    for (std::size_t y = 0; y < static_cast<std::size_t>(size.height); ++y) {
      double row = 0;
      for (std::size_t x = 0; x + 1 < width_; ++x) {
        row += cells[y * (width_ - 1) + x];
        sums_[(y + 1) * width_ + x + 1] = sums_[y * width_ + x + 1] + row;
      }
    }
  }

  Rectangle rectangle(int left, int top, int right, int bottom) const {
    Rectangle r{left, top, right, bottom, 0, 0, 0};
    r.light = std::max(0.0, at(right, bottom) - at(left, bottom) - at(right, top) + at(left, top));
    r.solid_angle = 2 * kPi * (right - left) / size_.width *
                    (std::cos(kPi * top / size_.height) - std::cos(kPi * bottom / size_.height));
    r.importance = r.light * std::pow(r.solid_angle, 0.25);
    return r;
  }

  // Across the longer side, where both parts have half of the light.
  std::pair<Rectangle, Rectangle> halves(const Rectangle& r) const {
    const int width = r.right - r.left, height = r.bottom - r.top;
    const double shortening = std::sin(kPi * 0.5 * (r.top + r.bottom) / size_.height);
    const double x_extent = 2 * shortening * width / size_.width, y_extent = static_cast<double>(height) / size_.height;
    const bool across = height < 2 || (width > 1 && x_extent >= y_extent);
    int low = (across ? r.left : r.top) + 1, high = (across ? r.right : r.bottom) - 1;
    while (low < high) {
      const int middle = (low + high) / 2;
      const Rectangle part =
          across ? rectangle(r.left, r.top, middle, r.bottom) : rectangle(r.left, r.top, r.right, middle);
      (2 * part.light < r.light ? low : high) = 2 * part.light < r.light ? middle + 1 : middle;
    }
    if (across) return {rectangle(r.left, r.top, low, r.bottom), rectangle(low, r.top, r.right, r.bottom)};
    return {rectangle(r.left, r.top, r.right, low), rectangle(r.left, low, r.right, r.bottom)};
  }

 private:
  double at(int x, int y) const { return sums_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)]; }

  Size size_;
  std::size_t width_;
  std::vector<double> sums_;
};

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

LightStrata LightStrata::rectangles(View<const float> latlong, int count) {
  LightStrata strata(latlong);
  const Table table(strata.luminances_, strata.cells_);
  std::priority_queue<Rectangle> open;
  std::vector<Rectangle> done;
  open.push(table.rectangle(0, 0, strata.cells_.width, strata.cells_.height));
  while (!open.empty() && static_cast<int>(open.size() + done.size()) < count) {
    const Rectangle largest = open.top();
    open.pop();
    if (largest.right - largest.left < 2 && largest.bottom - largest.top < 2) {
      done.push_back(largest);
      continue;
    }
    const auto [one, other] = table.halves(largest);
    open.push(one);
    open.push(other);
  }
  for (; !open.empty(); open.pop()) done.push_back(open.top());
  for (const Rectangle& r : done) {
    for (int y = r.top; y < r.bottom; ++y)
      for (int x = r.left; x < r.right; ++x) strata.append(y * strata.cells_.width + x);
    strata.end_stratum();
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
