#include "libhdr/render/internal/allotment.h"

#include <algorithm>
#include <cmath>

namespace hdr {
namespace {

constexpr int kReach = 2;  ///< pixels: neighbours are those of the 5 x 5 around
constexpr int kHighestLevel = 6;

// Sums over the 5 x 5 around each pixel, less the pixel itself.
std::vector<double> neighbour_sums(const std::vector<double>& values, Size size) {
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x);
  };
  std::vector<double> rows(values.size()), sums(values.size());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int i = std::max(0, x - kReach); i <= std::min(size.width - 1, x + kReach); ++i)
        rows[at(x, y)] += values[at(i, y)];
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      for (int j = std::max(0, y - kReach); j <= std::min(size.height - 1, y + kReach); ++j)
        sums[at(x, y)] += rows[at(x, j)];
      sums[at(x, y)] = std::max(0.0, sums[at(x, y)] - values[at(x, y)]);
    }
  }
  return sums;
}

// The level whose directions are nearest to `wanted`, in ratio; -1 for less than half of the base.
int level_of(double wanted, int base) {
  if (!(wanted > 0.5 * base)) return -1;
  return std::clamp(static_cast<int>(std::lround(std::log2(wanted / base))), 0, kHighestLevel);
}

bool shows_scene(const Film& film, std::size_t pixel) {
  return film.coverage(pixel) + film.ground_share(pixel) > 0;
}

void put(Allotment& allotment, std::size_t pixel, int level) {
  allotment.levels[pixel] = static_cast<std::int8_t>(level);
  allotment.highest = std::max(allotment.highest, level);
}

}  // namespace

std::vector<float> relative_deviations(const Film& film) {
  const Size size = film.size();
  const std::size_t count = film.count();
  double mean = 0, covered = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (!shows_scene(film, k)) continue;
    mean += film.luminance_of(k);
    ++covered;
  }
  const double least = 0.1 * mean / std::max(covered, 1.0);
  std::vector<double> variances(count), known(count), seen(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double value = film.luminance_of(k), variance = film.variance(k), scale = value * value + least * least;
    seen[k] = shows_scene(film, k);
    known[k] = variance >= 0 && scale > 0;
    if (known[k] > 0) variances[k] = variance * film.weight(k) / scale;
  }
  const std::vector<double> sums = neighbour_sums(variances, size), counts = neighbour_sums(known, size),
                            seen_around = neighbour_sums(seen, size);
  std::vector<float> deviations(count);
  for (std::size_t k = 0; k < count; ++k) {
    if (seen[k] + seen_around[k] == 0) continue;
    // A picture of one pixel has no neighbours: its own word is all there is.
    const double relative = counts[k] > 0 ? sums[k] / counts[k] : variances[k];
    deviations[k] = static_cast<float>(std::sqrt(relative));
  }
  return deviations;
}

std::vector<std::uint8_t> Allotment::others(int level) const {
  std::vector<std::uint8_t> mask(levels.size());
  for (std::size_t k = 0; k < levels.size(); ++k) mask[k] = levels[k] != level;
  return mask;
}

Allotment allot_budget(const Film& film, const std::vector<float>& deviations, double budget, int base) {
  Allotment allotment{std::vector<std::int8_t>(deviations.size(), -1), base, -1};
  const auto level_at = [&](std::size_t k, double factor) {
    return level_of(factor * static_cast<double>(deviations[k]) - film.weight(k), base);
  };
  const auto spent = [&](double factor) {
    double sum = 0;
    for (std::size_t k = 0; k < deviations.size(); ++k) {
      const int level = level_at(k, factor);
      if (level >= 0) sum += allotment.directions(level);
    }
    return sum;
  };
  // The largest factor whose work is within the budget, by bisection of its logarithm.
  const float largest = *std::max_element(deviations.begin(), deviations.end());
  if (!(largest > 0)) return allotment;
  double low = -20, high = 40;
  for (int step = 0; step < 24; ++step) {
    const double middle = 0.5 * (low + high);
    (spent(std::exp2(middle) / static_cast<double>(largest)) <= budget ? low : high) = middle;
  }
  for (std::size_t k = 0; k < deviations.size(); ++k)
    put(allotment, k, level_at(k, std::exp2(low) / static_cast<double>(largest)));
  return allotment;
}

Allotment allot_to_error(const Film& film, const std::vector<float>& deviations, double error, int base, double most) {
  Allotment allotment{std::vector<std::int8_t>(deviations.size(), -1), base, -1};
  for (std::size_t k = 0; k < deviations.size(); ++k) {
    const double has = film.weight(k), needs = std::pow(static_cast<double>(deviations[k]) / error, 2);
    const double lacks = std::min({needs - has, 4 * has, most - has});
    if (!(lacks > 0) || needs <= has) continue;
    put(allotment, k, std::max(0, level_of(lacks, base)));
  }
  return allotment;
}

}  // namespace hdr
