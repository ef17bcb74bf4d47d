#include "tests/bench/light_truth.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"

namespace hdr::bench {

Image<float> sky(int width) {
  Image<float> map(width, width / 2, 3);
  const Vec3 sun = Vec3(0.5, 0.6, 0.4).normalized();
  for_rows(map.height(), 8, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      Random random(1, static_cast<std::uint64_t>(y));
      for (int x = 0; x < width; ++x) {
        const Vec3 d = dir_from_latlong((x + 0.5) / width, (y + 0.5) / map.height());
        const double base = (d.y() > 0 ? 1.2 : 0.25) + 4e4 * std::exp(9000 * (d.dot(sun) - 1));
        for (int c = 0; c < 3; ++c) map(x, y, c) = static_cast<float>(base * (0.5 + random.uniform_float()));
      }
    }
  });
  return map;
}

float read_once(View<const float> map) {
  return reduce_rows(
      map.height(), 16, 0.0f,
      [&](int first, int last) {
        float sum[16] = {};
        for (int y = first; y < last; ++y) {
          const float* row = map.row(y);
          for (int k = 0; k + 16 <= 3 * map.width(); k += 16)
            for (int i = 0; i < 16; ++i) sum[i] += row[k + i];
        }
        return sum[0] + sum[1] + sum[2] + sum[3] + sum[4] + sum[5] + sum[6] + sum[7] + sum[8] + sum[9] + sum[10] +
               sum[11] + sum[12] + sum[13] + sum[14] + sum[15];
      },
      [](float& total, float part) { total += part; });
}

Sh brute_force(View<const float> map, int degree) {
  const auto count = static_cast<std::size_t>((degree + 1) * (degree + 1));
  const double nodes[3] = {0.5 - std::sqrt(0.15), 0.5, 0.5 + std::sqrt(0.15)},
               weights[3] = {5.0 / 18, 4.0 / 9, 5.0 / 18};
  const std::vector<Rgb> zero(count, Rgb::Zero());
  std::vector<Rgb> sum = reduce_rows(
      map.height(), 4, zero,
      [&](int first, int last) {
        std::vector<Rgb> part = zero;
        std::vector<double> y(count), cell(count);
        for (int row = first; row < last; ++row) {
          for (int x = 0; x < map.width(); ++x) {
            std::fill(cell.begin(), cell.end(), 0.0);
            for (int j = 0; j < 3; ++j) {
              const double v = (row + nodes[j]) / map.height();
              for (int i = 0; i < 3; ++i) {
                sh_basis(dir_from_latlong((x + nodes[i]) / map.width(), v), degree, y.data());
                const double w =
                    weights[i] * weights[j] * std::sin(kPi * v) * 2 * kPi / map.width() * kPi / map.height();
                for (std::size_t k = 0; k < count; ++k) cell[k] += w * y[k];
              }
            }
            const float* p = map.pixel(x, row);
            const Rgb radiance(p[0], p[1], p[2]);
            for (std::size_t k = 0; k < count; ++k) part[k] += cell[k] * radiance;
          }
        }
        return part;
      },
      [](std::vector<Rgb>& total, const std::vector<Rgb>& part) {
        for (std::size_t k = 0; k < total.size(); ++k) total[k] += part[k];
      });
  return {degree, std::move(sum)};
}

double relative_error(const Sh& sh, const Sh& truth) {
  double off = 0, size = 0;
  for (std::size_t k = 0; k < truth.coefficients.size(); ++k) {
    off += (sh.coefficients[k] - truth.coefficients[k]).square().sum();
    size += truth.coefficients[k].square().sum();
  }
  return std::sqrt(off / size);
}

std::vector<Vec3> spiral(int count) {
  std::vector<Vec3> normals;
  for (int k = 0; k < count; ++k) {
    const double y = 1 - (2 * k + 1.0) / count, azimuth = kPi * (3 - std::sqrt(5.0)) * k, s = std::sqrt(1 - y * y);
    normals.emplace_back(s * std::cos(azimuth), y, s * std::sin(azimuth));
  }
  return normals;
}

std::vector<Rgb> irradiance_truth(View<const float> latlong, const std::vector<Vec3>& normals) {
  const std::vector<DirectionalLight> pixels = pixel_lights(latlong);
  std::vector<Rgb> truth(normals.size());
  for_rows(static_cast<int>(normals.size()), 4, [&](int first, int last) {
    for (int k = first; k < last; ++k) {
      truth[static_cast<std::size_t>(k)] = irradiance(pixels, normals[static_cast<std::size_t>(k)]);
    }
  });
  return truth;
}

double rms_of_luminance(const std::vector<Rgb>& answer, const std::vector<Rgb>& truth) {
  double off = 0, size = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double e = luminance(truth[k][0], truth[k][1], truth[k][2]);
    off += std::pow(luminance(answer[k][0], answer[k][1], answer[k][2]) - e, 2);
    size += e * e;
  }
  return size > 0 ? std::sqrt(off / size) : 0;
}

}  // namespace hdr::bench
