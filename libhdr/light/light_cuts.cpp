// Median cut [Debevec05] and variance cut [Viriyothai09]: rectangles of the lat-long, cut in two until there are
// enough.
#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>

#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/light_cells.h"

namespace hdr {
namespace {

struct Rectangle {
  int x0, y0, x1, y1;
};

// Luminance and its first moment over a region.
struct Sums {
  double light = 0;
  Vec3 moment = Vec3::Zero();

  /// Integral of L |d - centroid|^2: as |d| = 1, it is light - |moment|^2 / light.
  double variance() const { return light > 0 ? std::max(0.0, light - moment.squaredNorm() / light) : 0; }
};

/// Summed-area tables [Crow84]: the sums of any rectangle from four corners.
class SummedTable {
 public:
  explicit SummedTable(const LightCells& cells)
      : stride_(cells.size.width + 1), sums_(static_cast<std::size_t>(stride_ * (cells.size.height + 1))) {
    for (int y = 0; y < cells.size.height; ++y) {
      Sums row;
      for (int x = 0; x < cells.size.width; ++x) {
        row.light += cells(x, y).luminance;
        row.moment += cells(x, y).moment;
        const Sums& above = at(x + 1, y);
        sums_[static_cast<std::size_t>((y + 1) * stride_ + x + 1)] = {above.light + row.light,
                                                                      above.moment + row.moment};
      }
    }
  }

  Sums of(const Rectangle& r) const {
    const Sums &a = at(r.x0, r.y0), &b = at(r.x1, r.y0), &c = at(r.x0, r.y1), &d = at(r.x1, r.y1);
    return {std::max(0.0, d.light - b.light - c.light + a.light), d.moment - b.moment - c.moment + a.moment};
  }

 private:
  const Sums& at(int x, int y) const { return sums_[static_cast<std::size_t>(y * stride_ + x)]; }

  int stride_;
  std::vector<Sums> sums_;
};

using Halves = std::pair<Rectangle, Rectangle>;

Halves cut_at(const Rectangle& r, bool upright, int place) {
  Rectangle a = r, b = r;
  (upright ? a.x1 : a.y1) = place;
  (upright ? b.x0 : b.y0) = place;
  return {a, b};
}

// Cuts `cells` until there are `count` rectangles: always the one with the largest `weight`, at `cut`.
Partition cut(const LightCells& cells, int count, const std::function<double(const Rectangle&)>& weight,
              const std::function<Halves(const Rectangle&)>& halves) {
  struct Entry {
    double weight;
    int order;  // of two of the same weight the older one goes first
    Rectangle region;
    bool operator<(const Entry& other) const {
      return weight != other.weight ? weight < other.weight : order > other.order;
    }
  };
  std::priority_queue<Entry> queue;
  std::vector<Rectangle> done;
  int made = 0;
  queue.push({0, made++, {0, 0, cells.size.width, cells.size.height}});
  while (!queue.empty() && static_cast<int>(queue.size() + done.size()) < count) {
    const Rectangle r = queue.top().region;
    queue.pop();
    if ((r.x1 - r.x0) * (r.y1 - r.y0) == 1) {
      done.push_back(r);
      continue;
    }
    const Halves parts = halves(r);
    for (const Rectangle& part : {parts.first, parts.second}) queue.push({weight(part), made++, part});
  }
  for (; !queue.empty(); queue.pop()) done.push_back(queue.top().region);
  Partition labels(cells.cells.size());
  for (std::size_t k = 0; k < done.size(); ++k) {
    for (int y = done[k].y0; y < done[k].y1; ++y)
      for (int x = done[k].x0; x < done[k].x1; ++x)
        labels[static_cast<std::size_t>(y * cells.size.width + x)] = static_cast<std::int32_t>(k);
  }
  return labels;
}

}  // namespace

Partition cut_by_median(const LightCells& cells, int count) {
  const SummedTable table(cells);
  const auto halves = [&](const Rectangle& r) {
    // Widths shrink with the cosine of the latitude in the middle.
    const double polar = kPi * 0.5 * (r.y0 + r.y1) / cells.size.height;
    const double wide = 2 * kPi * (r.x1 - r.x0) / cells.size.width * std::sin(polar);
    const double high = kPi * (r.y1 - r.y0) / cells.size.height;
    const bool upright = r.y1 - r.y0 == 1 || (wide > high && r.x1 - r.x0 > 1);
    const double half = 0.5 * table.of(r).light;
    int low = (upright ? r.x0 : r.y0) + 1, high_place = (upright ? r.x1 : r.y1) - 1;
    while (low < high_place) {
      const int middle = (low + high_place) / 2;
      if (table.of(cut_at(r, upright, middle).first).light < half) {
        low = middle + 1;
      } else {
        high_place = middle;
      }
    }
    // The place before may halve the light better.
    const auto unevenness = [&](int place) { return std::abs(table.of(cut_at(r, upright, place).first).light - half); };
    if (low - 1 > (upright ? r.x0 : r.y0) && unevenness(low - 1) < unevenness(low)) --low;
    return cut_at(r, upright, low);
  };
  return cut(
      cells, count, [&](const Rectangle& r) { return table.of(r).light; }, halves);
}

Partition cut_by_variance(const LightCells& cells, int count) {
  const SummedTable table(cells);
  const auto halves = [&](const Rectangle& r) {
    Halves best = cut_at(r, r.x1 - r.x0 > 1, r.x1 - r.x0 > 1 ? (r.x0 + r.x1) / 2 : (r.y0 + r.y1) / 2);
    double least = std::numeric_limits<double>::infinity();
    for (const bool upright : {true, false}) {
      const int first = (upright ? r.x0 : r.y0) + 1, last = upright ? r.x1 : r.y1;
      for (int place = first; place < last; ++place) {
        const Halves parts = cut_at(r, upright, place);
        const double sum = table.of(parts.first).variance() + table.of(parts.second).variance();
        if (sum >= least) continue;
        least = sum;
        best = parts;
      }
    }
    return best;
  };
  return cut(
      cells, count, [&](const Rectangle& r) { return table.of(r).variance(); }, halves);
}

}  // namespace hdr
