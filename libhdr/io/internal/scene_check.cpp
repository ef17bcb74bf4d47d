#include "libhdr/io/internal/scene_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libhdr/core/error.h"

namespace hdr::internal {
namespace {

constexpr int kLongerSide = 64;
constexpr int kSamplesASide = 4;  // of each cell
constexpr int kReach = 7;         // cells that a hand may have moved: 11 % of the longer side

/// Ranks of the usable codes, ties sharing their mean, spread over -1 .. 1.
std::vector<float> ranks_of(const std::vector<float>& code) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < code.size(); ++k) {
    if (code[k] >= 0) order.push_back(k);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return code[a] < code[b]; });
  std::vector<float> rank(code.size());
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    while (last < order.size() && code[order[last]] == code[order[first]]) ++last;
    const double middle = 0.5 * static_cast<double>(first + last - 1);
    const auto value = static_cast<float>(2 * (middle + 0.5) / static_cast<double>(order.size()) - 1);
    for (std::size_t k = first; k < last; ++k) rank[order[k]] = value;
  }
  return rank;
}

/// Calls visit(cell of a, cell of b) for every pair of cells that are usable in both when b is shifted by (dx, dy).
template <class Visit>
void for_shared_cells(const SceneThumbnail& a, const SceneThumbnail& b, int dx, int dy, const Visit& visit) {
  const auto [width, height] = a.size;
  for (int y = std::max(0, -dy); y < std::min(height, height - dy); ++y) {
    for (int x = std::max(0, -dx); x < std::min(width, width - dx); ++x) {
      const auto p = static_cast<std::size_t>(y * width + x), q = static_cast<std::size_t>((y + dy) * width + x + dx);
      if (a.code[p] >= 0 && b.code[q] >= 0) visit(p, q);
    }
  }
}

struct Correlation {
  int cells = 0;
  double r = 0;
};

Correlation correlation_of_ranks(const SceneThumbnail& a, const SceneThumbnail& b, int dx, int dy) {
  double n = 0, sa = 0, sb = 0, aa = 0, bb = 0, ab = 0;
  for_shared_cells(a, b, dx, dy, [&](std::size_t p, std::size_t q) {
    const double u = a.rank[p], v = b.rank[q];
    n += 1;
    sa += u;
    sb += v;
    aa += u * u;
    bb += v * v;
    ab += u * v;
  });
  const double spread = (n * aa - sa * sa) * (n * bb - sb * sb);
  return {static_cast<int>(n), spread > 0 ? (n * ab - sa * sb) / std::sqrt(spread) : 0};
}

/// Median distance of b's codes from a rising curve through them: the medians of 16 parts of a's ranks.
double residual_of_curve(const SceneThumbnail& a, const SceneThumbnail& b, int dx, int dy) {
  struct Pair {
    float rank, code;
  };
  std::vector<Pair> pairs;
  for_shared_cells(a, b, dx, dy, [&](std::size_t p, std::size_t q) { pairs.push_back({a.rank[p], b.code[q]}); });
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& s, const Pair& t) { return s.rank < t.rank; });
  constexpr std::size_t kParts = 16;
  std::vector<float> distances, part;
  float floor = 0;
  for (std::size_t k = 0; k < kParts; ++k) {
    const std::size_t first = k * pairs.size() / kParts, last = (k + 1) * pairs.size() / kParts;
    if (first == last) continue;
    part.clear();
    for (std::size_t i = first; i < last; ++i) part.push_back(pairs[i].code);
    const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
    std::nth_element(part.begin(), middle, part.end());
    floor = std::max(floor, *middle);  // rising
    for (const float code : part) distances.push_back(std::abs(code - floor));
  }
  if (distances.empty()) return 0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

enum class Verdict { kIncomparable, kSame, kDoubt, kOther };

Verdict verdict_on(const SceneAgreement& agreement) {
  constexpr int kFewestCells = 100;
  // Neighbours in real brackets: .90 and more (a shaken hand), two apart .78. Photographs of different places: .2 in
  // the middle, .45 one time in ten, .78 at most. Between the two nothing is said.
  constexpr double kSame = 0.8, kOther = 0.6;
  constexpr double kFlat =
      4;  // codes: noise alone ranks what has no contrast (.57 in the dark of a scan, within 2 codes)
  if (agreement.cells < kFewestCells) return Verdict::kIncomparable;
  if (agreement.correlation >= kSame) return Verdict::kSame;
  return agreement.correlation < kOther && agreement.residual > kFlat ? Verdict::kOther : Verdict::kDoubt;
}

/// The shots that agree with `first`, or with one that does, and so on.
std::vector<std::size_t> agreeing_with(std::size_t first, const std::vector<std::vector<Verdict>>& verdicts) {
  std::vector<std::size_t> group = {first};
  for (std::size_t k = 0; k < group.size(); ++k) {
    for (std::size_t other = 0; other < verdicts.size(); ++other) {
      const bool known = std::find(group.begin(), group.end(), other) != group.end();
      if (!known && verdicts[group[k]][other] == Verdict::kSame) group.push_back(other);
    }
  }
  return group;
}

}  // namespace

SceneThumbnail thumbnail_of(const PhotoSamples& samples, int max_code) {
  constexpr double kDarkest = 5, kBrightest = 250;  // of 255: beyond them noise and compression smear the ends
  const auto averaged = [&](const auto& codes) {
    const int cell = std::max(1, (std::max(codes.width(), codes.height()) + kLongerSide - 1) / kLongerSide);
    const int count = std::min(cell, kSamplesASide);
    const auto place = [&](int k, int i) { return k * cell + (2 * i + 1) * cell / (2 * count); };
    SceneThumbnail thumbnail{{codes.width() / cell, codes.height() / cell}, {}, {}};
    for (int v = 0; v < thumbnail.size.height; ++v) {
      for (int u = 0; u < thumbnail.size.width; ++u) {
        double sum = 0;
        for (int i = 0; i < count * count; ++i) {
          const double code = 255.0 * codes(place(u, i % count), place(v, i / count), 1) / max_code;
          sum += code >= kDarkest && code <= kBrightest ? code : -std::numeric_limits<double>::infinity();
        }
        thumbnail.code.push_back(sum >= 0 ? static_cast<float>(sum / (count * count)) : -1.0f);
      }
    }
    return thumbnail;
  };
  SceneThumbnail thumbnail = std::visit(averaged, samples.lattice);
  thumbnail.rank = ranks_of(thumbnail.code);
  return thumbnail;
}

SceneAgreement scene_agreement(const SceneThumbnail& a, const SceneThumbnail& b) {
  HDR_ASSERT(a.size == b.size);
  const Correlation still = correlation_of_ranks(a, b, 0, 0);
  constexpr double kCertain = 0.9;
  if (still.r >= kCertain) return {still.cells, still.r, residual_of_curve(a, b, 0, 0)};
  Correlation best = still;
  int best_x = 0, best_y = 0;
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      const Correlation here = correlation_of_ranks(a, b, dx, dy);
      if (2 * here.cells < still.cells || here.r <= best.r) continue;  // a few cells agree by chance
      best = here;
      best_x = dx;
      best_y = dy;
    }
  }
  return {best.cells, best.r, residual_of_curve(a, b, best_x, best_y)};
}

std::optional<std::string> stranger_among(const std::vector<Photo>& shots, std::span<const SceneThumbnail> thumbnails) {
  const std::size_t count = shots.size();
  std::vector<std::vector<Verdict>> verdicts(count, std::vector<Verdict>(count, Verdict::kIncomparable));
  constexpr std::size_t kNeighbours = 2;  // across a stranger, its neighbours are compared with each other
  bool any = false;
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t j = k + 1; j < std::min(count, k + 1 + kNeighbours); ++j) {
      verdicts[k][j] = verdicts[j][k] = verdict_on(scene_agreement(thumbnails[k], thumbnails[j]));
      any |= verdicts[k][j] == Verdict::kOther;
    }
  }
  if (!any) return std::nullopt;
  std::vector<std::size_t> scene;  // what most shots show
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<std::size_t> group = agreeing_with(k, verdicts);
    if (group.size() > scene.size()) scene = std::move(group);
  }
  const auto shows_scene = [&](std::size_t k) { return std::find(scene.begin(), scene.end(), k) != scene.end(); };
  for (std::size_t k = 0; k < count; ++k) {
    if (shows_scene(k)) continue;
    const auto says = [&](Verdict verdict) {
      return std::find_if(scene.begin(), scene.end(), [&](std::size_t other) { return verdicts[k][other] == verdict; });
    };
    const auto other = says(Verdict::kOther);
    // A thing that fills what one pair can compare leaves the others in doubt.
    if (other == scene.end() || says(Verdict::kDoubt) != scene.end()) continue;
    return fmt::format("{}: shows another scene than {}", shots[k].path.string(), shots[*other].path.string());
  }
  return std::nullopt;
}

}  // namespace hdr::internal
