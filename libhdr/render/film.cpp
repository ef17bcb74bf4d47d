#include "libhdr/render/internal/film.h"

#include <algorithm>

#include "libhdr/core/color.h"

namespace hdr {

Film::Film(Size size)
    : size_(size), pixels_(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height)) {}

void Film::add(std::size_t pixel, const PixelEstimate& estimate, double weight) {
  Pixel& sum = pixels_[pixel];
  const double value = luminance(estimate.radiance[0], estimate.radiance[1], estimate.radiance[2]);
  sum.radiance += weight * estimate.radiance;
  sum.normal += static_cast<float>(weight) * estimate.normal;
  sum.squares += weight * value * value;
  sum.weight += weight;
  sum.coverage += weight * static_cast<double>(estimate.coverage);
  sum.ground += weight * estimate.ground;
  sum.ground_share += weight * static_cast<double>(estimate.ground_share);
  sum.doubt = estimate.doubt;
  ++sum.passes;
}

Rgb Film::radiance(std::size_t pixel) const {
  return pixels_[pixel].radiance / std::max(pixels_[pixel].weight, 1e-300);
}

float Film::coverage(std::size_t pixel) const {
  return static_cast<float>(pixels_[pixel].coverage / std::max(pixels_[pixel].weight, 1e-300));
}

Rgb Film::ground(std::size_t pixel) const {
  return pixels_[pixel].ground / std::max(pixels_[pixel].weight, 1e-300);
}

float Film::ground_share(std::size_t pixel) const {
  return static_cast<float>(pixels_[pixel].ground_share / std::max(pixels_[pixel].weight, 1e-300));
}

Vec3f Film::normal(std::size_t pixel) const {
  return pixels_[pixel].normal / static_cast<float>(std::max(pixels_[pixel].weight, 1e-30));
}

double Film::luminance_of(std::size_t pixel) const {
  const Rgb mean = radiance(pixel);
  return luminance(mean[0], mean[1], mean[2]);
}

// With variances v / w_i of the passes, sum of w_i (x_i - mean)^2 / (passes - 1) estimates v, and v / sum of w_i is the
// variance of their weighted mean.
double Film::variance(std::size_t pixel) const {
  const Pixel& sum = pixels_[pixel];
  if (sum.passes < 2) return -1;
  const double mean = luminance_of(pixel);
  return std::max(0.0, sum.squares / sum.weight - mean * mean) / (sum.passes - 1);
}

double Film::square_error(std::size_t pixel) const {
  const double by_chance = variance(pixel);
  return by_chance < 0 ? by_chance : by_chance + doubt(pixel) * doubt(pixel);
}

}  // namespace hdr
