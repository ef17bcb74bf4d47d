// The hole around -Y: a membrane over it (Laplace's equation), from coarse to fine, on an equidistant picture of the
// ground, where the pole is nothing special.
#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/stitch.h"

namespace hdr {
namespace {

/// The pixels without alpha below the horizon that are connected with the lowest row, over the seam too.
std::vector<std::uint8_t> hole_of(View<const float> alpha) {
  const int width = alpha.width(), height = alpha.height();
  std::vector<std::uint8_t> hole(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::vector<std::pair<int, int>> open;
  const auto visit = [&](int x, int y) {
    x = (x + width) % width;
    if (y < height / 2 || y >= height || alpha(x, y) > 0) return;
    auto& here = hole[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    if (here) return;
    here = 1;
    open.emplace_back(x, y);
  };
  for (int x = 0; x < width; ++x) visit(x, height - 1);
  while (!open.empty()) {
    const auto [x, y] = open.back();
    open.pop_back();
    visit(x - 1, y);
    visit(x + 1, y);
    visit(x, y - 1);
    visit(x, y + 1);
  }
  return hole;
}

/// Half the size: the mean of what is known.
void pull(const Image<float>& rgb, const Image<float>& known, Image<float>& half_rgb, Image<float>& half_known) {
  const int side = (rgb.width() + 1) / 2;
  half_rgb = Image<float>(side, side, 3);
  half_known = Image<float>(side, side, 1);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      double sum[3] = {0, 0, 0}, count = 0;
      for (int k = 0; k < 4; ++k) {
        const int i = std::min(2 * x + (k & 1), rgb.width() - 1), j = std::min(2 * y + (k >> 1), rgb.width() - 1);
        if (known(i, j) == 0) continue;
        ++count;
        for (int c = 0; c < 3; ++c) sum[c] += static_cast<double>(rgb(i, j, c));
      }
      if (count == 0) continue;
      half_known(x, y) = 1;
      for (int c = 0; c < 3; ++c) half_rgb(x, y, c) = static_cast<float>(sum[c] / count);
    }
  }
}

/// A lat-long between four pixels, when all of them are known.
bool look(const RadianceMap& map, const Vec3& dir, float* rgb) {
  const Vec2 uv = latlong_from_dir(dir);
  const int width = map.rgb.width(), height = map.rgb.height();
  const double x = uv.x() * width - 0.5, y = std::clamp(uv.y() * height - 0.5, 0.0, height - 1.0);
  const double left = std::floor(x), top = std::min(std::floor(y), height - 2.0);
  double sum[3] = {0, 0, 0};
  for (int k = 0; k < 4; ++k) {
    const int i = (static_cast<int>(left) + (k & 1) + width) % width, j = static_cast<int>(top) + (k >> 1);
    const double weight = ((k & 1) ? x - left : 1 - (x - left)) * ((k >> 1) ? y - top : 1 - (y - top));
    if (map.alpha(i, j) == 0) return false;
    for (int c = 0; c < 3; ++c) sum[c] += weight * static_cast<double>(map.rgb(i, j, c));
  }
  for (int c = 0; c < 3; ++c) rgb[c] = static_cast<float>(sum[c]);
  return true;
}

float bilinear(const Image<float>& picture, double x, double y, int c) {
  x = std::clamp(x, 0.0, picture.width() - 1.0);
  y = std::clamp(y, 0.0, picture.height() - 1.0);
  const int i = std::min(static_cast<int>(x), picture.width() - 1),
            j = std::min(static_cast<int>(y), picture.height() - 1);
  const int i1 = std::min(i + 1, picture.width() - 1), j1 = std::min(j + 1, picture.height() - 1);
  const double u = x - i, v = y - j;
  return static_cast<float>(
      (1 - v) * ((1 - u) * static_cast<double>(picture(i, j, c)) + u * static_cast<double>(picture(i1, j, c))) +
      v * ((1 - u) * static_cast<double>(picture(i, j1, c)) + u * static_cast<double>(picture(i1, j1, c))));
}

/// Each unknown pixel becomes the mean of its neighbours, some times over (red and black in turn).
void relax(Image<float>& rgb, const Image<float>& known) {
  constexpr int kSweeps = 30;
  const int side = rgb.width();
  for (int sweep = 0; sweep < 2 * kSweeps; ++sweep) {
    for_rows(side, 32, [&](int first, int last) {
      for (int y = first; y < last; ++y) {
        for (int x = (y + sweep) & 1; x < side; x += 2) {
          if (known(x, y) > 0) continue;
          const int left = std::max(0, x - 1), right = std::min(side - 1, x + 1);
          const int up = std::max(0, y - 1), down = std::min(side - 1, y + 1);
          for (int c = 0; c < 3; ++c) {
            rgb(x, y, c) = 0.25f * (rgb(left, y, c) + rgb(right, y, c) + rgb(x, up, c) + rgb(x, down, c));
          }
        }
      }
    });
  }
}

void fill(Image<float>& rgb, const Image<float>& known) {
  if (rgb.width() > 2) {
    Image<float> half_rgb, half_known;
    pull(rgb, known, half_rgb, half_known);
    fill(half_rgb, half_known);
    for (int y = 0; y < rgb.height(); ++y) {
      for (int x = 0; x < rgb.width(); ++x) {
        if (known(x, y) > 0) continue;
        for (int c = 0; c < 3; ++c) rgb(x, y, c) = bilinear(half_rgb, 0.5 * x - 0.25, 0.5 * y - 0.25, c);
      }
    }
  }
  relax(rgb, known);
}

}  // namespace

NadirFill fill_nadir(RadianceMap& latlong) {
  NadirFill done;
  if (latlong.alpha.empty()) return done;
  const Size size = latlong.size();
  const std::vector<std::uint8_t> hole = hole_of(latlong.alpha);
  const auto in_hole = [&](int x, int y) {
    return hole[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x)] != 0;
  };
  int highest = size.height;
  bool anything_known = false;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      if (in_hole(x, y)) {
        highest = std::min(highest, y);
        done.solid_angle += latlong_pixel_solid_angle(y, size.width, size.height);
      }
      anything_known |= latlong.alpha(x, y) > 0;
    }
  }
  if (highest == size.height || !anything_known) return {};
  done.radius_degrees = 180.0 * (size.height - highest) / size.height;
  // A few degrees more, for its border.
  const double fov = std::min(359.0, 2 * (done.radius_degrees + 4));
  const int side = std::clamp(static_cast<int>(fov / 360 * size.width), 32, 1024);
  const Fisheye ground{inscribed_disc(side), fov};
  const Mat3 probe_from_ground = Eigen::AngleAxisd(kPi / 2, Vec3::UnitX()).toRotationMatrix();  // +Z to -Y
  Image<float> rgb(side, side, 3), known(side, side, 1);
  for_rows(side, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < side; ++x) {
        // Beyond the disc nothing is known either: there the membrane ends freely.
        const auto ray = ground.dir_from_px({x + 0.5, y + 0.5});
        if (ray && look(latlong, probe_from_ground * *ray, rgb.pixel(x, y))) known(x, y) = 1;
      }
    }
  });
  fill(rgb, known);
  for (int y = highest; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      if (!in_hole(x, y)) continue;
      const Vec3 dir = dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height);
      const auto px = ground.px_from_dir(probe_from_ground.transpose() * dir);
      if (!px) continue;
      for (int c = 0; c < 3; ++c) latlong.rgb(x, y, c) = bilinear(rgb, px->x() - 0.5, px->y() - 0.5, c);
      latlong.alpha(x, y) = 1;
    }
  }
  return done;
}

}  // namespace hdr
