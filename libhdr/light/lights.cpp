#include "libhdr/light/lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/light_cells.h"
#include "libhdr/light/internal/match_irradiance.h"

namespace hdr {
namespace {

constexpr int kLargestWidth = 1024;

Partition partition(const LightCells& cells, const LightsOptions& options) {
  switch (options.method) {
    case LightsMethod::kMedianCut:
      return cut_by_median(cells, options.count);
    case LightsMethod::kVarianceCut:
      return cut_by_variance(cells, options.count);
    case LightsMethod::kStructured:
      return cut_by_structure(cells, options.count);
    case LightsMethod::kKolligKeller:
      break;
  }
  return cut_by_relaxation(cells, options.count);
}

// A region's sums.
struct Stratum {
  DirectionalLight light;
  Vec3 moment = Vec3::Zero(), area = Vec3::Zero();
  double luminance = 0;

  Vec3 centroid() const {
    if (moment.norm() > 1e-12 * luminance) return moment.normalized();
    return area.norm() > 0 ? Vec3(area.normalized()) : light.direction;
  }
  /// Root mean square angle of its light from the centroid, radians (chords taken for angles).
  double spread() const {
    if (!(luminance > 0)) return 0;
    return std::sqrt(2 * std::max(0.0, 1 - moment.norm() / luminance));
  }
};

std::vector<Stratum> strata_of(const LightCells& cells, const Partition& labels) {
  const std::int32_t count = 1 + *std::max_element(labels.begin(), labels.end());
  std::vector<Stratum> strata(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const LightCell& cell = cells.cells[k];
    Stratum& stratum = strata[static_cast<std::size_t>(labels[k])];
    stratum.light.irradiance += cell.light;
    stratum.light.solid_angle += cell.solid_angle;
    stratum.light.direction = cell.middle;
    stratum.moment += cell.moment;
    stratum.area += cell.solid_angle * cell.middle;
    stratum.luminance += cell.luminance;
  }
  return strata;
}

// One place in each region, uniform in solid angle: reservoir sampling by cells.
void jitter(const LightCells& cells, const Partition& labels, std::uint64_t seed,
            std::vector<DirectionalLight>& lights) {
  std::vector<double> seen(lights.size(), 0.0);
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const auto label = static_cast<std::size_t>(labels[k]);
    seen[label] += cells.cells[k].solid_angle;
    Random random(seed, k);
    if (random.uniform() * seen[label] < cells.cells[k].solid_angle) lights[label].direction = cells.cells[k].middle;
  }
}

}  // namespace

std::optional<LightsMethod> lights_method_from_name(const std::string& name) {
  if (name == "median-cut") return LightsMethod::kMedianCut;
  if (name == "variance-cut") return LightsMethod::kVarianceCut;
  if (name == "structured") return LightsMethod::kStructured;
  if (name == "kollig-keller") return LightsMethod::kKolligKeller;
  return std::nullopt;
}

std::optional<LightPlacement> light_placement_from_name(const std::string& name) {
  if (name == "centroid") return LightPlacement::kCentroid;
  if (name == "matched") return LightPlacement::kMatched;
  if (name == "jittered") return LightPlacement::kJittered;
  return std::nullopt;
}

Lights make_lights(View<const float> latlong, const LightsOptions& options) {
  if (options.count < 1) throw Error(fmt::format("{} lights: there must be at least one", options.count));
  const LightCells cells = light_cells(latlong, kLargestWidth);
  const Partition labels = partition(cells, options);
  const std::vector<Stratum> strata = strata_of(cells, labels);
  std::vector<DirectionalLight> lights;
  std::vector<double> reach;
  for (const Stratum& stratum : strata) {
    lights.push_back(stratum.light);
    lights.back().direction = stratum.centroid();
    reach.push_back(stratum.spread());
  }
  const LightPlacement placement = options.placement.value_or(
      options.method == LightsMethod::kMedianCut ? LightPlacement::kCentroid : LightPlacement::kMatched);
  if (placement == LightPlacement::kMatched) match_irradiance(cells, reach, lights);
  if (placement == LightPlacement::kJittered) jitter(cells, labels, options.seed, lights);

  std::vector<std::int32_t> order(lights.size()), place(lights.size());
  std::iota(order.begin(), order.end(), 0);
  const auto brightness = [&](std::int32_t k) { return strata[static_cast<std::size_t>(k)].luminance; };
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return brightness(a) > brightness(b); });
  Lights result;
  for (std::size_t k = 0; k < order.size(); ++k) {
    result.lights.push_back(lights[static_cast<std::size_t>(order[k])]);
    place[static_cast<std::size_t>(order[k])] = static_cast<std::int32_t>(k);
  }
  result.strata = Image<std::int32_t>(cells.size, 1);
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const auto cell = static_cast<int>(k);
    result.strata(cell % cells.size.width, cell / cells.size.width) = place[static_cast<std::size_t>(labels[k])];
  }
  return result;
}

std::vector<DirectionalLight> pixel_lights(View<const float> latlong) {
  HDR_ASSERT(latlong.channels() == 3);
  std::vector<DirectionalLight> lights;
  for (int y = 0; y < latlong.height(); ++y) {
    const double solid_angle = latlong_pixel_solid_angle(y, latlong.width(), latlong.height());
    for (int x = 0; x < latlong.width(); ++x) {
      const float* p = latlong.pixel(x, y);
      if (p[0] == 0 && p[1] == 0 && p[2] == 0) continue;
      lights.push_back({dir_from_latlong((x + 0.5) / latlong.width(), (y + 0.5) / latlong.height()),
                        solid_angle * Rgb(p[0], p[1], p[2]), solid_angle});
    }
  }
  return lights;
}

Rgb irradiance(const std::vector<DirectionalLight>& lights, const Vec3& n) {
  Rgb sum = Rgb::Zero();
  for (const DirectionalLight& light : lights) sum += std::max(0.0, light.direction.dot(n)) * light.irradiance;
  return sum;
}

double irradiance_rms_error(const std::vector<DirectionalLight>& lights, View<const float> latlong) {
  const LightCells cells = light_cells(latlong, 512);
  if (cells.black) return 0;
  // Normals on a Fibonacci spiral, each for the same solid angle.
  constexpr int kNormals = 512;
  struct Squares {
    double error = 0, map = 0;
  };
  const Squares squares = reduce_rows(
      kNormals, 8, Squares{},
      [&](int first, int last) {
        Squares part;
        for (int k = first; k < last; ++k) {
          const double y = 1 - (2 * k + 1.0) / kNormals, azimuth = kPi * (3 - std::sqrt(5.0)) * k;
          const double s = std::sqrt(1 - y * y);
          const Vec3 n(s * std::cos(azimuth), y, s * std::sin(azimuth));
          // The moments are luminance times direction: their dot products with n are its cosines, already weighted.
          double e = 0;
          for (const LightCell& cell : cells.cells) e += std::max(0.0, cell.moment.dot(n));
          const Rgb of_lights = irradiance(lights, n);
          const double off = luminance(of_lights[0], of_lights[1], of_lights[2]) - e;
          part.error += off * off;
          part.map += e * e;
        }
        return part;
      },
      [](Squares& total, const Squares& part) {
        total.error += part.error;
        total.map += part.map;
      });
  return std::sqrt(squares.error / squares.map);
}

}  // namespace hdr
