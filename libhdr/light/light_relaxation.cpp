// [Kollig03]: a Voronoi diagram of the sphere whose cells hold alike much light. Cells with the most light are given a
// second point, and Lloyd's relaxation moves every point to the centroid of its cell's light, until there are enough.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "libhdr/core/parallel.h"
#include "libhdr/light/internal/light_cells.h"

namespace hdr {
namespace {

constexpr int kRelaxations = 6;  // of each round; the cells hardly move after some

class Relaxation {
 public:
  explicit Relaxation(const LightCells& cells) : cells_(cells), labels_(cells.cells.size(), 0) {
    double brightest = -1;
    for (std::size_t k = 0; k < cells.cells.size(); ++k) {
      const double radiance = cells.cells[k].luminance / cells.cells[k].solid_angle;
      if (radiance <= brightest) continue;
      brightest = radiance;
      points_ = {cells.cells[k].middle};
    }
  }

  Partition run(int count) {
    relax(1);
    while (static_cast<int>(points_.size()) < count) {
      const std::size_t before = points_.size();
      split(std::min(count - static_cast<int>(before), static_cast<int>(before)));
      if (points_.size() == before) break;
      relax(kRelaxations);
    }
    fill_empty();
    return std::move(labels_);
  }

 private:
  // The cell of the diagram with the most light first.
  void split(int most) {
    std::vector<std::size_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return light_[a] > light_[b]; });
    const double average = std::accumulate(light_.begin(), light_.end(), 0.0) / static_cast<double>(light_.size());
    int made = 0;
    for (const std::size_t k : order) {
      // Only bright cells are split, so that light evens out; one at least.
      if (made == most || (made > 0 && light_[k] < average)) break;
      if (farthest_[k] < 0) continue;  // one cell of the map: nothing to split
      points_.push_back(cells_.cells[static_cast<std::size_t>(farthest_[k])].middle);
      ++made;
    }
  }

  // Two points that met leave one without cells: it takes one of the label that has most of them.
  void fill_empty() {
    std::vector<std::int32_t> held(points_.size(), 0);
    for (const std::int32_t label : labels_) ++held[static_cast<std::size_t>(label)];
    for (std::size_t k = 0; k < held.size(); ++k) {
      if (held[k] > 0) continue;
      const auto richest = std::max_element(held.begin(), held.end());
      if (*richest < 2) return;
      const auto label = static_cast<std::int32_t>(richest - held.begin());
      *std::find(labels_.begin(), labels_.end(), label) = static_cast<std::int32_t>(k);
      --*richest;
      held[k] = 1;
    }
  }

  void relax(int times) {
    for (int step = 0; step < times; ++step) {
      assign();
      for (std::size_t k = 0; k < points_.size(); ++k)
        if (moment_[k].norm() > 0) points_[k] = moment_[k].normalized();
    }
    assign();
  }

  void assign() {
    label_cells();
    light_.assign(points_.size(), 0.0);
    moment_.assign(points_.size(), Vec3::Zero());
    farthest_.assign(points_.size(), -1);
    std::vector<double> spread(points_.size(), 0);
    for (std::size_t i = 0; i < labels_.size(); ++i) {
      const LightCell& cell = cells_.cells[i];
      const auto k = static_cast<std::size_t>(labels_[i]);
      light_[k] += cell.luminance;
      moment_[k] += cell.moment;
      // Where a second point pays: far from the first, and bright.
      const double pull = cell.luminance * (points_[k] - cell.middle).squaredNorm();
      if (pull <= spread[k]) continue;
      spread[k] = pull;
      farthest_[k] = static_cast<std::int32_t>(i);
    }
  }

  void label_cells() {
    std::vector<Vec3f> points;
    for (const Vec3& p : points_) points.push_back(p.cast<float>());
    for_rows(cells_.count(), 4096, [&](int first, int last) {
      std::vector<float> best(static_cast<std::size_t>(last - first), -2.0f);
      std::vector<float> x, y, z;
      for (int i = first; i < last; ++i) {
        const Vec3f d = cells_.cells[static_cast<std::size_t>(i)].middle.cast<float>();
        x.push_back(d.x());
        y.push_back(d.y());
        z.push_back(d.z());
      }
      for (std::size_t k = 0; k < points.size(); ++k) {
        for (std::size_t i = 0; i < best.size(); ++i) {
          const float cosine = points[k].x() * x[i] + points[k].y() * y[i] + points[k].z() * z[i];
          if (cosine <= best[i]) continue;
          best[i] = cosine;
          labels_[static_cast<std::size_t>(first) + i] = static_cast<std::int32_t>(k);
        }
      }
    });
  }

  const LightCells& cells_;
  std::vector<Vec3> points_, moment_;
  std::vector<double> light_;
  std::vector<std::int32_t> farthest_;
  Partition labels_;
};

}  // namespace

Partition cut_by_relaxation(const LightCells& cells, int count) {
  return Relaxation(cells).run(std::min(count, cells.count()));
}

}  // namespace hdr
