#include "libhdr/light/internal/light_cells.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

// The columns of a map: sine and cosine of the azimuth of their middles.
struct Columns {
  explicit Columns(int width) {
    for (int x = 0; x < width; ++x) {
      const double azimuth = 2 * kPi * (0.5 - (x + 0.5) / width);
      sine.push_back(std::sin(azimuth));
      cosine.push_back(std::cos(azimuth));
    }
  }
  std::vector<double> sine, cosine;
};

// Adds a part of a row to a cell.
void add_pixels(View<const float> map, int y, int x0, int x1, const Columns& columns, LightCell& cell) {
  const double polar = kPi * (y + 0.5) / map.height(),
               solid_angle = latlong_pixel_solid_angle(y, map.width(), map.height());
  Rgb light = Rgb::Zero();
  double across = 0, along = 0;
  for (int x = x0; x < x1; ++x) {
    const float* p = map.pixel(x, y);
    const double value = luminance<double>(p[0], p[1], p[2]);
    light += Rgb(p[0], p[1], p[2]);
    across += value * columns.sine[static_cast<std::size_t>(x)];
    along += value * columns.cosine[static_cast<std::size_t>(x)];
  }
  cell.light += solid_angle * light;
  const double value = luminance(light[0], light[1], light[2]);
  cell.moment += solid_angle * Vec3(std::sin(polar) * across, std::cos(polar) * value, std::sin(polar) * along);
  cell.solid_angle += solid_angle * (x1 - x0);
}

}  // namespace

LightCells light_cells(View<const float> latlong, int largest_width) {
  HDR_ASSERT(latlong.channels() == 3 && !latlong.empty() && largest_width > 0);
  const int block = (latlong.width() + largest_width - 1) / largest_width;
  LightCells result;
  result.size = {(latlong.width() + block - 1) / block, (latlong.height() + block - 1) / block};
  const auto width = static_cast<std::size_t>(result.size.width);
  result.cells.resize(width * static_cast<std::size_t>(result.size.height));
  const Columns columns(latlong.width());
  for_rows(result.size.height, 4, [&](int first, int last) {
    for (int row = first; row < last; ++row) {
      const int y0 = row * block, y1 = std::min(y0 + block, latlong.height());
      for (int column = 0; column < result.size.width; ++column) {
        const int x0 = column * block, x1 = std::min(x0 + block, latlong.width());
        LightCell& cell = result.cells[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column)];
        for (int y = y0; y < y1; ++y) add_pixels(latlong, y, x0, x1, columns, cell);
        cell.luminance = luminance(cell.light[0], cell.light[1], cell.light[2]);
        cell.middle = dir_from_latlong(0.5 * (x0 + x1) / latlong.width(), 0.5 * (y0 + y1) / latlong.height());
      }
    }
  });
  double total = 0;
  for (const LightCell& cell : result.cells) total += cell.luminance;
  result.black = !(total > 0);
  if (result.black) {
    for (LightCell& cell : result.cells) {
      cell.luminance = cell.solid_angle;
      cell.moment = cell.solid_angle * cell.middle;
    }
  }
  return result;
}

}  // namespace hdr
