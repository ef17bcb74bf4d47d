#include "libhdr/merge/internal/ghost_plan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>

#include "libhdr/core/parallel.h"
#include "libhdr/merge/internal/cell_mask.h"

namespace hdr::internal {
namespace {

// Deviations, in units of PairAgreement. Noise alone passes the higher one once in 5e8 cells.
constexpr int kLow = static_cast<int>(3 * PairAgreement::kUnit), kHigh = static_cast<int>(6 * PairAgreement::kUnit);
constexpr int kSeeds = 4;  ///< cells over the higher one that make a region
/// Within a region, where something did move, less evidence leaves a shot out.
constexpr int kHighInside = static_cast<int>(4 * PairAgreement::kUnit), kSeedsInside = 2;
constexpr int kGap = 2;  ///< half of the gaps that are closed, cells
/// Evidence this close, as a share of the longer side, is one region and has one reference: a thing that looks like
/// what is behind its middle is not shown by halves.
constexpr int kNear = 40;
constexpr std::size_t kJudged = 20000;  ///< cells of a region that choose its reference, about

/// A region while its shots are judged: cells of a box, the pairs' disagreement in it.
struct Judged {
  CellBox box;
  std::vector<int> cells;                        ///< of the box
  std::vector<std::vector<std::uint8_t>> pairs;  ///< disagreement of shots j < k at pair_of(j, k)
};

std::size_t pair_of(std::size_t j, std::size_t k) {
  if (j > k) std::swap(j, k);
  return k * (k - 1) / 2 + j;
}

class Planner {
 public:
  Planner(const CellGrid& grid, const MergeModel& model, const std::vector<CellShot>& shots)
      : grid_(grid), model_(model), shots_(shots), pairs_(shots.size() * (shots.size() - 1) / 2) {}

  GhostPlan plan() {
    GhostPlan plan;
    plan.grid = grid_;
    plan.trust.resize(shots_.size());
    const std::vector<std::uint8_t> evidence = disagreement();
    const CellMask moved = filled(closed(hysteresis(evidence, evidence, grid_.cells, kLow, kHigh, kSeeds), gap()));
    for (const std::vector<int>& piece : pieces(moved)) judge(piece, plan);
    return plan;
  }

 private:
  int gap() const { return std::max(kGap, std::max(grid_.cells.width, grid_.cells.height) / kNear); }

  /// Pairs j < k with k - j up to `distance`, their medians found.
  std::vector<std::size_t> pairs_within(std::size_t distance) {
    std::vector<std::size_t> indices, first, second;
    for (std::size_t k = 1; k < shots_.size(); ++k) {
      for (std::size_t j = k < distance ? 0 : k - distance; j < k; ++j) {
        indices.push_back(pair_of(j, k));
        first.push_back(j);
        second.push_back(k);
      }
    }
    for_rows(static_cast<int>(indices.size()), 1, [&](int task, int) {
      const auto i = static_cast<std::size_t>(task);
      std::optional<PairAgreement>& agreement = pairs_[indices[i]];
      if (!agreement) agreement.emplace(grid_, model_, shots_[first[i]], shots_[second[i]]);
    });
    return indices;
  }

  /// The most that neighbours in exposure, and next neighbours, disagree. Shots farther apart share little light.
  std::vector<std::uint8_t> disagreement() {
    const std::vector<std::size_t> compared = pairs_within(2);
    std::vector<std::uint8_t> evidence(static_cast<std::size_t>(grid_.count()));
    constexpr int kRows = 16;
    for_rows(grid_.cells.height, kRows, [&](int first, int last) {
      const CellBox box{0, first, grid_.cells.width, last};
      std::vector<std::uint8_t> part(box.count());
      for (const std::size_t index : compared) pairs_[index]->raise(box, part);
      std::copy(part.begin(), part.end(), evidence.begin() + static_cast<std::ptrdiff_t>(first) * grid_.cells.width);
    });
    return evidence;
  }

  Judged examine(const std::vector<int>& piece) {
    Judged region;
    CellBox& box = region.box;
    box = {grid_.cells.width, grid_.cells.height, 0, 0};
    for (const int cell : piece) {
      const int x = cell % grid_.cells.width, y = cell / grid_.cells.width;
      box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1), std::max(box.y1, y + 1)};
    }
    for (const int cell : piece) {
      region.cells.push_back((cell / grid_.cells.width - box.y0) * box.width() + cell % grid_.cells.width - box.x0);
    }
    std::sort(region.cells.begin(), region.cells.end());
    const std::vector<std::size_t> compared = pairs_within(shots_.size());
    region.pairs.resize(compared.size());
    for_rows(static_cast<int>(compared.size()), 1, [&](int first, int) {
      const std::size_t index = compared[static_cast<std::size_t>(first)];
      region.pairs[index].resize(box.count());
      pairs_[index]->raise(box, region.pairs[index]);
      pairs_[index]->raise_by_texture(box, kHighInside, region.pairs[index]);
    });
    return region;
  }

  /// The other shots by distance in exposure, the longer of two at the same one first.
  std::vector<std::size_t> order_from(std::size_t reference) const {
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < shots_.size(); ++k) {
      if (k != reference) order.push_back(k);
    }
    const auto distance = [&](std::size_t k) {
      return std::abs(std::log2(shots_[k].exposure / shots_[reference].exposure));
    };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return distance(a) != distance(b) ? distance(a) < distance(b) : a > b;
    });
    return order;
  }

  /// Squared signal over noise of a pixel, in the channel where it is least; 0 where the cell only bounds the light.
  float worth(std::size_t shot, std::size_t cell) const {
    const CellPicture& picture = shots_[shot].picture;
    if (picture.flags[cell]) return 0;
    float least = INFINITY;
    for (std::size_t c = 0; c < 3; ++c) {
      const float level = picture.level[3 * cell + c];
      least = std::min(least, level * level * model_.channel[c].precision.at(level));
    }
    return least;
  }

  std::size_t cell_of(const CellBox& box, int cell) const {
    return static_cast<std::size_t>((box.y0 + cell / box.width()) * grid_.cells.width + box.x0 + cell % box.width());
  }

  /// Visits about `most` cells of the region, spread over it.
  template <class Visit>
  void for_some(const Judged& region, std::size_t most, const Visit& visit) const {
    const std::size_t step = std::max<std::size_t>(1, region.cells.size() / most);
    for (std::size_t i = 0; i < region.cells.size(); i += step) {
      visit(static_cast<std::size_t>(region.cells[i]), cell_of(region.box, region.cells[i]));
    }
  }

  /// The relative variance, at most 1 a cell, summed over the region, that the shots leave which agree with `reference`
  /// cell by cell: what whole pieces of shots can reach at best.
  double least_risk_of(const Judged& region, std::size_t reference) const {
    const std::vector<std::size_t> order = order_from(reference);
    std::vector<std::size_t> agreeing;
    double risk = 0;
    for_some(region, kJudged, [&](std::size_t at, std::size_t cell) {
      agreeing.assign(1, reference);
      double all = worth(reference, cell);
      for (const std::size_t k : order) {
        const bool agrees = std::all_of(agreeing.begin(), agreeing.end(),
                                        [&](std::size_t m) { return region.pairs[pair_of(k, m)][at] < kLow; });
        if (!agrees) continue;
        agreeing.push_back(k);
        all += worth(k, cell);
      }
      risk += 1 / (1 + all);
    });
    return risk;
  }

  using Kept = std::vector<std::pair<std::size_t, CellMask>>;  ///< shots, and where each is left out
  /// The shots that agree with `reference`, and where they do not.
  struct Agreement {
    std::size_t reference = 0;
    double risk = 0;
    Kept kept;
  };
  Agreement agreement_with(const Judged& region, std::size_t reference) const {
    Agreement agreement{reference, 0, {}};
    agreement.kept.emplace_back(reference, CellMask({region.box.width(), region.box.height()}));
    for (const std::size_t k : order_from(reference)) {
      agreement.kept.emplace_back(k, left_out(region, k, agreement.kept));
    }
    for_some(region, kJudged, [&](std::size_t at, std::size_t cell) {
      double all = 0;
      for (const auto& [k, gone] : agreement.kept) all += gone.set[at] ? 0 : worth(k, cell);
      agreement.risk += 1 / (1 + all);
    });
    return agreement;
  }

  /// Does shot j say nothing against the shots that are kept in this cell?
  static bool agrees(const Judged& region, std::size_t j, const Kept& kept, std::size_t at) {
    return std::all_of(kept.begin(), kept.end(), [&](const auto& shot) {
      return shot.first == j || shot.second.set[at] || region.pairs[pair_of(j, shot.first)][at] < kLow;
    });
  }

  /// Where shot k disagrees with the shots of `kept`, each in the cells where it is kept; whole pieces, without holes.
  CellMask left_out(const Judged& region, std::size_t k, const Kept& kept) const {
    const Size size{region.box.width(), region.box.height()};
    std::vector<std::uint8_t> evidence(region.box.count()), reach(region.box.count());
    CellMask measured(size);
    for (const auto& [m, gone] : kept) {
      const std::vector<std::uint8_t>& pair = region.pairs[pair_of(k, m)];
      for (const int cell : region.cells) {
        const auto at = static_cast<std::size_t>(cell);
        if (gone.set[at]) continue;
        evidence[at] = std::max(evidence[at], pair[at]);
        measured.set[at] |= worth(m, cell_of(region.box, cell)) > 0;
      }
    }
    // Where the shots that are kept are clipped or black, agreeing with them proves little: there a thing that they
    // contradict beside reaches as far as any shot contradicts it which they do not contradict.
    for (const int cell : region.cells) {
      const auto at = static_cast<std::size_t>(cell);
      reach[at] = evidence[at];
      for (std::size_t j = 0; j < shots_.size() && !measured.set[at]; ++j) {
        if (j != k && agrees(region, j, kept, at)) reach[at] = std::max(reach[at], region.pairs[pair_of(k, j)][at]);
      }
    }
    CellMask mask = hysteresis(reach, evidence, size, kLow, kHighInside, kSeedsInside);
    // Where shot k itself is clipped or black it says next to nothing, and what shows between may be specks of another
    // moment, too small to tell. Between pieces that are left out all of that goes.
    const auto mute = [&](int cell) {
      return measured.set[static_cast<std::size_t>(cell)] && worth(k, cell_of(region.box, cell)) == 0;
    };
    const CellMask near = closed(mask, gap());
    for (const int cell : region.cells) {
      const auto at = static_cast<std::size_t>(cell);
      mask.set[at] |= near.set[at] && mute(cell);
    }
    mask = filled(closed(mask, kGap));
    // A shot that disagrees with most of a region shows something else there: no half of it is kept.
    std::size_t count = 0, of = 0;
    for (const int cell : region.cells) {
      if (mute(cell)) continue;
      count += mask.set[static_cast<std::size_t>(cell)];
      ++of;
    }
    if (4 * count > 3 * of) {
      for (const int cell : region.cells) mask.set[static_cast<std::size_t>(cell)] = 1;
    }
    return mask;
  }

  /// Of the shots that can at best be a good reference, the one that is.
  Agreement best_agreement(const Judged& region) const {
    constexpr std::size_t kCandidates = 4;
    std::vector<double> risks(shots_.size());
    for_rows(static_cast<int>(shots_.size()), 1, [&](int k, int) {
      risks[static_cast<std::size_t>(k)] = least_risk_of(region, static_cast<std::size_t>(k));
    });
    std::vector<std::size_t> order(shots_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return risks[a] < risks[b]; });
    order.resize(std::min(order.size(), kCandidates));
    std::vector<Agreement> agreements(order.size());
    for_rows(static_cast<int>(order.size()), 1, [&](int k, int) {
      agreements[static_cast<std::size_t>(k)] = agreement_with(region, order[static_cast<std::size_t>(k)]);
    });
    return *std::min_element(agreements.begin(), agreements.end(),
                             [](const Agreement& a, const Agreement& b) { return a.risk < b.risk; });
  }

  void judge(const std::vector<int>& piece, GhostPlan& plan) {
    const Judged region = examine(piece);
    const Agreement agreement = best_agreement(region);
    GhostRegion out;
    out.reference = static_cast<int>(agreement.reference);
    constexpr int kMargin = 2;
    const CellBox wide{std::max(0, region.box.x0 - kMargin), std::max(0, region.box.y0 - kMargin),
                       std::min(grid_.cells.width, region.box.x1 + kMargin),
                       std::min(grid_.cells.height, region.box.y1 + kMargin)};
    CellMask touched({wide.width(), wide.height()});
    for (const auto& [k, mask] : agreement.kept) {
      if (withdraw(region.box, mask, wide, kMargin, plan.trust[k], touched))
        out.left_out.push_back(static_cast<int>(k));
    }
    if (out.left_out.empty()) return;
    std::sort(out.left_out.begin(), out.left_out.end());
    describe(wide, touched, out);
    plan.regions.push_back(out);
  }

  /// Trust falls to 0 in the cells of `mask` and those beside them, and to a half in the next ones.
  bool withdraw(const CellBox& box, const CellMask& mask, const CellBox& wide, int margin,
                std::vector<std::uint8_t>& trust, CellMask& touched) const {
    const bool any = std::any_of(mask.set.begin(), mask.set.end(), [](std::uint8_t v) { return v != 0; });
    if (!any) return false;
    constexpr std::uint8_t kHalf = 128;
    trust.resize(static_cast<std::size_t>(grid_.count()), 255);
    CellMask own({wide.width(), wide.height()});
    for (int y = box.y0; y < box.y1; ++y) {
      for (int x = box.x0; x < box.x1; ++x) {
        own.set[static_cast<std::size_t>((y - wide.y0) * wide.width() + x - wide.x0)] =
            mask.set[static_cast<std::size_t>((y - box.y0) * box.width() + x - box.x0)];
      }
    }
    const CellMask none = dilated(own, 1), less = dilated(own, margin);
    for (std::size_t k = 0; k < less.set.size(); ++k) {
      if (!less.set[k]) continue;
      const std::size_t cell = cell_of(wide, static_cast<int>(k));
      trust[cell] = std::min(trust[cell], none.set[k] ? std::uint8_t{0} : kHalf);
      touched.set[k] = 1;
    }
    return true;
  }

  void describe(const CellBox& wide, const CellMask& touched, GhostRegion& out) const {
    out.x0 = grid_.size.width;
    out.y0 = grid_.size.height;
    for (int y = wide.y0; y < wide.y1; ++y) {
      for (int x = wide.x0; x < wide.x1; ++x) {
        if (!touched.set[static_cast<std::size_t>((y - wide.y0) * wide.width() + x - wide.x0)]) continue;
        const int right = std::min(grid_.size.width, (x + 1) * grid_.side);
        const int bottom = std::min(grid_.size.height, (y + 1) * grid_.side);
        out.x0 = std::min(out.x0, x * grid_.side);
        out.y0 = std::min(out.y0, y * grid_.side);
        out.x1 = std::max(out.x1, right);
        out.y1 = std::max(out.y1, bottom);
        out.pixels += static_cast<std::int64_t>(right - x * grid_.side) * (bottom - y * grid_.side);
      }
    }
  }

  const CellGrid& grid_;
  const MergeModel& model_;
  const std::vector<CellShot>& shots_;
  std::vector<std::optional<PairAgreement>> pairs_;
};

}  // namespace

GhostPlan plan_ghosts(const CellGrid& grid, const MergeModel& model, const std::vector<CellShot>& shots) {
  if (shots.size() < 2) return {grid, std::vector<std::vector<std::uint8_t>>(shots.size()), {}};
  return Planner(grid, model, shots).plan();
}

GhostPlan plan_ghosts(const Bracket& bracket, const std::vector<double>& exposures, const Alignment& alignment,
                      const MergeModel& model, const std::vector<std::size_t>& shots) {
  const CellGrid grid = cell_grid(bracket.size());
  std::vector<std::unique_ptr<Source>> sources;
  for (const std::size_t j : shots) {
    const Photo& photo = bracket.shots[j];
    sources.push_back(
        std::make_unique<Source>(photo, alignment.frames[j].ref_from_photo, model, exposures[j], band_height_of(grid)));
  }
  std::vector<CellPicture> pictures = cell_pictures(grid, model, sources);
  std::vector<CellShot> cells(shots.size());
  for_rows(static_cast<int>(shots.size()), 1, [&](int task, int) {
    const auto k = static_cast<std::size_t>(task);
    cells[k].picture = std::move(pictures[k]);
    cells[k].exposure = sources[k]->exposure();
    cells[k].residual_px = static_cast<float>(alignment.frames[shots[k]].residual_px);
    cells[k].find_range(grid);
    cells[k].find_colours();
  });
  return plan_ghosts(grid, model, cells);
}

}  // namespace hdr::internal
