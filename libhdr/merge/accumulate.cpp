#include "libhdr/merge/internal/accumulate.h"

#include <algorithm>
#include <cmath>

namespace hdr {
namespace {

template <class Code>
void add_row(const Image<Code>& image, const ContributionTable& table, int closing_code, int y, RowSums& sums) {
  const Code* codes = image.row(y);
  const Contribution* channel[3] = {table[0].data(), table[1].data(), table[2].data()};
  float* radiance = sums.weighted_radiance.data();
  float* weight = sums.weight.data();
  float* open = sums.open.data();
  const int samples = image.width() * 3;
  for (int k = 0; k < samples; k += 3) {
    for (int c = 0; c < 3; ++c) {
      const Contribution part = channel[c][codes[k + c]];
      radiance[k + c] += open[k + c] * part.weighted_radiance;
      weight[k + c] += open[k + c] * part.weight;
    }
  }
  for (int k = 0; k < samples; ++k) open[k] = codes[k] < closing_code ? open[k] : 0.0f;
}

template <class Code>
void add_warped_row(const Image<Code>& image, const ContributionTable& table, int closing_code,
                    const Mat3& photo_from_ref, int y, RowSums& sums) {
  const int width = image.width(), height = image.height();
  for (int x = 0; x < width; ++x) {
    const Vec3 p = photo_from_ref * Vec3(x, y, 1);
    const double px = p.x() / p.z(), py = p.y() / p.z();
    // A pixel reaches half a pixel beyond its centre; NaN and points behind the camera fail the test.
    if (!(p.z() > 0 && px >= -0.5 && py >= -0.5 && px <= width - 0.5 && py <= height - 0.5)) continue;
    const double left = std::floor(px), top = std::floor(py);
    const float u = static_cast<float>(px - left), v = static_cast<float>(py - top);
    const int x0 = std::max(0, static_cast<int>(left)), x1 = std::min(width - 1, static_cast<int>(left) + 1);
    const int y0 = std::max(0, static_cast<int>(top)), y1 = std::min(height - 1, static_cast<int>(top) + 1);
    const float share[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    const Code* corner[4] = {image.pixel(x0, y0), image.pixel(x1, y0), image.pixel(x0, y1), image.pixel(x1, y1)};
    const int nearest = (u < 0.5f ? 0 : 1) + (v < 0.5f ? 0 : 2);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t sample = static_cast<std::size_t>(3 * x) + c;
      for (int k = 0; k < 4; ++k) {
        const Contribution& part = table[c][corner[k][c]];
        sums.weighted_radiance[sample] += sums.open[sample] * share[k] * part.weighted_radiance;
        sums.weight[sample] += sums.open[sample] * share[k] * part.weight;
      }
      if (corner[nearest][c] >= closing_code) sums.open[sample] = 0;
    }
  }
}

}  // namespace

void RowSums::clear() {
  std::fill(weighted_radiance.begin(), weighted_radiance.end(), 0.0f);
  std::fill(weight.begin(), weight.end(), 0.0f);
  std::fill(open.begin(), open.end(), 1.0f);
}

void accumulate_row(const Codes& codes, const ContributionTable& table, int closing_code, int y, RowSums& sums) {
  std::visit([&](const auto& image) { add_row(image, table, closing_code, y, sums); }, codes);
}

void accumulate_warped_row(const Codes& codes, const ContributionTable& table, int closing_code,
                           const Mat3& photo_from_ref, int y, RowSums& sums) {
  std::visit([&](const auto& image) { add_warped_row(image, table, closing_code, photo_from_ref, y, sums); }, codes);
}

}  // namespace hdr
