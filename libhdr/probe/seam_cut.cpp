#include "libhdr/probe/internal/seam_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr::internal {
namespace {

constexpr float kMostDifferent = 1.5f;  ///< of ln: what differs by more is as bad
constexpr double kLength = 0.02;        ///< cost of a seam where nothing differs: the shorter the better
constexpr double kPreference = 1.0;     ///< of a layer's own cost, an area, against seams, a length (radians)
constexpr double kNever = 1e6;

/// What layers differ by, pixel by pixel: a metric, as alpha-expansion needs it.
class Differences {
 public:
  explicit Differences(const std::vector<SeamLayer>& layers) : layers_(layers) {
    for (const SeamLayer& layer : layers) {
      Image<float> logs(layer.rgb.size(), 3);
      for (int y = 0; y < logs.height(); ++y) {
        for (int x = 0; x < logs.width(); ++x) {
          for (int c = 0; c < 3; ++c) logs(x, y, c) = std::log(std::max(layer.rgb(x, y, c), 1e-12f));
        }
      }
      logs_.push_back(std::move(logs));
    }
  }
  bool shown(int layer, int x, int y) const { return layers_[at(layer)].shown(x, y) > 0; }
  double cost(int layer, int x, int y) const {
    return shown(layer, x, y) ? kPreference * static_cast<double>(layers_[at(layer)].cost(x, y)) : kNever;
  }
  double between(int a, int b, int x, int y) const {
    if (a == b) return 0;
    if (!shown(a, x, y) || !shown(b, x, y)) return static_cast<double>(kMostDifferent);
    const float *p = logs_[at(a)].pixel(x, y), *q = logs_[at(b)].pixel(x, y);
    const float difference = std::max({std::abs(p[0] - q[0]), std::abs(p[1] - q[1]), std::abs(p[2] - q[2])});
    return kLength + static_cast<double>(std::min(difference, kMostDifferent));
  }

 private:
  static std::size_t at(int layer) { return static_cast<std::size_t>(layer); }

  const std::vector<SeamLayer>& layers_;
  std::vector<Image<float>> logs_;
};

/// The graph of one expansion: of each pixel that a layer may take over, whether it should.
class Expansion {
 public:
  Expansion(const Differences& differences, Image<std::int32_t>& labels)
      : differences_(differences), labels_(labels), nodes_(labels.size(), 1) {}

  /// Whether anything changed.
  bool grow(int layer) {
    const int count = number_nodes(layer);
    if (count == 0) return false;
    graph_ = Graph(static_cast<unsigned>(count + 1), static_cast<unsigned>(4 * count));
    for (int k = 0; k <= count; ++k) graph_.addVtx();
    graph_.addEdges(0, count, 0, 0);  // a graph without any edge is beyond it
    sinks_.assign(static_cast<std::size_t>(count), 0);
    sources_.assign(static_cast<std::size_t>(count), 0);
    const int width = labels_.width(), height = labels_.height();
    const double step = kPi / height;
    for (int y = 0; y < height; ++y) {
      const double here = std::sin(kPi * (y + 0.5) / height), below = std::sin(kPi * (y + 1.0) / height);
      for (int x = 0; x < width; ++x) {
        if (labels_(x, y) < 0) continue;
        if (nodes_(x, y) >= 0) {
          const double area = here * step * step;
          add_terms(nodes_(x, y), area * differences_.cost(labels_(x, y), x, y), area * differences_.cost(layer, x, y));
        }
        add_pair(layer, x, y, (x + 1) % width, y, step);  // a seam between columns is a row high
        if (y + 1 < height) add_pair(layer, x, y, x, y + 1, below * step);
      }
    }
    for (int k = 0; k < count; ++k) {
      graph_.addTermWeights(k, sources_[static_cast<std::size_t>(k)], sinks_[static_cast<std::size_t>(k)]);
    }
    graph_.maxFlow();
    return take_over(layer);
  }

 private:
  using Graph = cv::detail::GCGraph<double>;

  int number_nodes(int layer) {
    int count = 0;
    for (int y = 0; y < labels_.height(); ++y) {
      for (int x = 0; x < labels_.width(); ++x) {
        const bool free = labels_(x, y) >= 0 && labels_(x, y) != layer && differences_.shown(layer, x, y);
        nodes_(x, y) = free ? count++ : -1;
      }
    }
    return count;
  }

  /// What it costs a node to keep its label, and to change: the source's side keeps.
  void add_terms(int node, double keep, double change) {
    sinks_[static_cast<std::size_t>(node)] += keep;
    sources_[static_cast<std::size_t>(node)] += change;
  }

  double seam(int a, int b, int x, int y, int u, int v) const {
    return a == b ? 0 : differences_.between(a, b, x, y) + differences_.between(a, b, u, v);
  }

  /// The four costs of two neighbours, [Kolmogorov04]'s way into a graph.
  void add_pair(int layer, int x, int y, int u, int v, double length) {
    const int a = labels_(x, y), b = labels_(u, v), p = nodes_(x, y), q = nodes_(u, v);
    if (b < 0 || (p < 0 && q < 0)) return;
    const double both = length * seam(a, b, x, y, u, v);
    if (p >= 0 && q >= 0) {
      const double first = length * seam(a, layer, x, y, u, v), second = length * seam(layer, b, x, y, u, v);
      // keep, keep: both; keep, change: first; change, keep: second; change, change: 0.
      add_terms(p, both, second);
      add_terms(q, 0, -second);
      graph_.addEdges(p, q, std::max(0.0, first + second - both), 0.0);
      return;
    }
    if (p >= 0) return add_terms(p, both, length * seam(layer, b, x, y, u, v));
    add_terms(q, both, length * seam(a, layer, x, y, u, v));
  }

  bool take_over(int layer) {
    bool changed = false;
    for (int y = 0; y < labels_.height(); ++y) {
      for (int x = 0; x < labels_.width(); ++x) {
        if (nodes_(x, y) < 0 || graph_.inSourceSegment(nodes_(x, y))) continue;
        labels_(x, y) = layer;
        changed = true;
      }
    }
    return changed;
  }

  const Differences& differences_;
  Image<std::int32_t>& labels_;
  Image<std::int32_t> nodes_;
  Graph graph_;
  std::vector<double> sources_, sinks_;
};

/// Each pixel to whom it costs least.
Image<std::int32_t> first_labels(const Differences& differences, Size size, int layers) {
  Image<std::int32_t> labels(size, 1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      int best = -1;
      for (int k = 0; k < layers; ++k) {
        if (!differences.shown(k, x, y)) continue;
        if (best < 0 || differences.cost(k, x, y) < differences.cost(best, x, y)) best = k;
      }
      labels(x, y) = best;
    }
  }
  return labels;
}

/// A layer's part, softened over three pixels.
Image<float> softened(const Image<std::int32_t>& labels, int layer) {
  static constexpr std::array<float, 3> kTaps = {0.25f, 0.5f, 0.25f};
  const int width = labels.width(), height = labels.height();
  Image<float> across(labels.size(), 1), result(labels.size(), 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int k = -1; k <= 1; ++k) {
        const bool here = labels((x + k + width) % width, y) == layer;
        across(x, y) += here ? kTaps[static_cast<std::size_t>(k + 1)] : 0;
      }
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int k = -1; k <= 1; ++k) {
        result(x, y) += kTaps[static_cast<std::size_t>(k + 1)] * across(x, std::clamp(y + k, 0, height - 1));
      }
    }
  }
  return result;
}

}  // namespace

SeamCut::SeamCut(const std::vector<SeamLayer>& layers) {
  constexpr int kMostRounds = 4;
  const int count = static_cast<int>(layers.size());
  HDR_ASSERT(count > 0);
  const Differences differences(layers);
  labels_ = first_labels(differences, layers.front().rgb.size(), count);
  Expansion expansion(differences, labels_);
  bool changed = count > 1;
  for (int round = 0; changed && round < kMostRounds; ++round) {
    changed = false;
    for (int k = 0; k < count; ++k) changed |= expansion.grow(k);
  }
  for (int k = 0; k < count; ++k) shares_.push_back(softened(labels_, k));
}

double SeamCut::share(std::size_t k, const Vec2& uv) const {
  const Image<float>& map = shares_[k];
  const double x = uv.x() * map.width() - 0.5, y = std::clamp(uv.y() * map.height() - 0.5, 0.0, map.height() - 1.0);
  const int left = static_cast<int>(std::floor(x)), top = std::min(static_cast<int>(y), map.height() - 2);
  const double fx = x - left, fy = y - top;
  const auto column = [&](int c) { return (c % map.width() + map.width()) % map.width(); };
  const auto at = [&](int c, int r) { return static_cast<double>(map(column(c), r)); };
  return (1 - fy) * ((1 - fx) * at(left, top) + fx * at(left + 1, top)) +
         fy * ((1 - fx) * at(left, top + 1) + fx * at(left + 1, top + 1));
}

}  // namespace hdr::internal
