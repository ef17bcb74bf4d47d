// Structured importance sampling [Agarwal03]. The sphere is thresholded at multiples of the standard deviation of its
// radiance, from the brightest level down; the connected components of a level share the samples by their importance
//   Gamma = L dw^(1/4),  L the light of the region, dw its solid angle, at most dw_0 = .01 (sections 3.1 and 4.1),
// and are cut into as many strata around farthest points [Hochbaum85], seeded with those of the brighter levels inside
// them, from which dimmer samples thus keep away. A share below one sample is carried down to the region around.
#include <algorithm>
#include <cmath>
#include <limits>

#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/components.h"
#include "libhdr/light/internal/light_cells.h"

namespace hdr {
namespace {

constexpr int kLevels = 6;          // d of the paper: thresholds 0, 1, ... 5 standard deviations
constexpr double kCoherent = 0.01;  // dw_0, steradians: above it visibility is no more alike
constexpr double kAngleExponent = 0.25;

double importance(double light, double solid_angle) {
  return light * std::pow(std::min(solid_angle, kCoherent) / kCoherent, kAngleExponent);
}

using CellList = std::vector<std::int32_t>;

class Stratifier {
 public:
  Stratifier(const LightCells& cells, int count)
      : cells_(cells),
        count_(count),
        labels_(cells.cells.size(), -1),
        share_(cells.cells.size(), 0.0),
        unlabelled_(cells.count()) {}

  Partition run() {
    const double deviation = standard_deviation();
    double total = 0;
    const int levels = deviation > 0 ? kLevels : 1;
    for (int level = levels - 1; level >= 0; --level) {
      components_.push_back(connected_components(above(level * deviation), cells_.size));
      for (const CellList& component : components_.back()) total += importance_of(component, level, deviation);
    }
    for (int level = levels - 1; level >= 0; --level) {
      for (const CellList& component : components_[static_cast<std::size_t>(levels - 1 - level)]) {
        const double wanted = count_ * importance_of(component, level, deviation) / total + carried(component);
        place(component, wanted);
      }
    }
    return std::move(labels_);
  }

 private:
  double radiance(std::int32_t cell) const {
    const LightCell& c = cells_.cells[static_cast<std::size_t>(cell)];
    return c.luminance / c.solid_angle;
  }

  double standard_deviation() const {
    double mean = 0, square = 0, sphere = 0;
    for (const LightCell& c : cells_.cells) {
      sphere += c.solid_angle;
      mean += c.luminance;
    }
    mean /= sphere;
    for (const LightCell& c : cells_.cells) {
      const double off = c.luminance / c.solid_angle - mean;
      square += off * off * c.solid_angle;
    }
    return std::sqrt(square / sphere);
  }

  std::vector<std::uint8_t> above(double threshold) const {
    std::vector<std::uint8_t> inside(cells_.cells.size());
    for (std::int32_t k = 0; k < cells_.count(); ++k)
      inside[static_cast<std::size_t>(k)] = threshold <= 0 || radiance(k) >= threshold;
    return inside;
  }

  // Of the part that no brighter level has.
  double importance_of(const CellList& component, int level, double deviation) const {
    const bool highest = level + 1 == kLevels || deviation == 0;
    const double limit = highest ? std::numeric_limits<double>::infinity() : (level + 1) * deviation;
    double light = 0, solid_angle = 0;
    for (const std::int32_t cell : component) {
      if (radiance(cell) >= limit) continue;
      light += cells_.cells[static_cast<std::size_t>(cell)].luminance;
      solid_angle += cells_.cells[static_cast<std::size_t>(cell)].solid_angle;
    }
    return importance(light, solid_angle);
  }

  // What the components inside left over: kept at one of their cells.
  double carried(const CellList& component) {
    double sum = 0;
    for (const std::int32_t cell : component) {
      sum += share_[static_cast<std::size_t>(cell)];
      share_[static_cast<std::size_t>(cell)] = 0;
    }
    return sum;
  }

  int placed() const { return static_cast<int>(centres_.size()); }

  void place(const CellList& component, double wanted) {
    CellList free;
    for (const std::int32_t cell : component)
      if (labels_[static_cast<std::size_t>(cell)] < 0) free.push_back(cell);
    // Whoever has all that is left of the sphere has all samples that are left; until then one is kept for it.
    const int left = count_ - placed();
    const bool rest = static_cast<int>(free.size()) == unlabelled_;
    int count = rest ? left : std::min(static_cast<int>(wanted + 1e-9), left - 1);
    count = std::clamp(count, 0, static_cast<int>(free.size()));
    if (count > 0) {
      cut_around_farthest(component, free, count);
      unlabelled_ -= static_cast<int>(free.size());
    }
    share_[static_cast<std::size_t>(component[0])] = std::max(0.0, wanted - count);
  }

  Vec3f middle(std::int32_t cell) const { return cells_.cells[static_cast<std::size_t>(cell)].middle.cast<float>(); }

  void cut_around_farthest(const CellList& component, const CellList& free, int count) {
    std::vector<Vec3f> places;
    for (const std::int32_t cell : free) places.push_back(middle(cell));
    std::vector<float> nearest(free.size(), -2.0f);  // cosine to the nearest centre
    std::vector<std::uint8_t> here(cells_.cells.size(), 0);
    for (const std::int32_t cell : component) here[static_cast<std::size_t>(cell)] = 1;
    bool seeded = false;
    for (const std::int32_t centre : centres_) {
      if (!here[static_cast<std::size_t>(centre)]) continue;
      seeded = true;
      const Vec3f c = middle(centre);
      for (std::size_t k = 0; k < free.size(); ++k) nearest[k] = std::max(nearest[k], places[k].dot(c));
    }
    std::vector<float> own(free.size(), -2.0f);  // to the nearest centre of this component
    for (int k = 0; k < count; ++k) {
      const std::size_t next = k == 0 && !seeded ? brightest(free) : farthest(nearest, own);
      const auto label = static_cast<std::int32_t>(centres_.size());
      centres_.push_back(free[next]);
      const Vec3f c = places[next];
      for (std::size_t i = 0; i < free.size(); ++i) {
        const float cosine = places[i].dot(c);
        nearest[i] = std::max(nearest[i], cosine);
        if (cosine <= own[i]) continue;
        own[i] = cosine;
        labels_[static_cast<std::size_t>(free[i])] = label;
      }
      own[next] = nearest[next] = 2;  // its own, for good
      labels_[static_cast<std::size_t>(free[next])] = label;
    }
  }

  std::size_t brightest(const CellList& free) const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < free.size(); ++k)
      if (radiance(free[k]) > radiance(free[best])) best = k;
    return best;
  }

  // No centre twice: their cosines are 2.
  static std::size_t farthest(const std::vector<float>& nearest, const std::vector<float>& own) {
    std::size_t best = nearest.size();
    for (std::size_t k = 0; k < nearest.size(); ++k)
      if (own[k] < 2 && (best == nearest.size() || nearest[k] < nearest[best])) best = k;
    HDR_ASSERT(best < nearest.size());
    return best;
  }

  const LightCells& cells_;
  int count_;
  Partition labels_;
  std::vector<double> share_;
  int unlabelled_;
  CellList centres_;
  std::vector<std::vector<CellList>> components_;  ///< of each level, from the brightest
};

}  // namespace

Partition cut_by_structure(const LightCells& cells, int count) {
  return Stratifier(cells, std::min(count, cells.count())).run();
}

}  // namespace hdr
