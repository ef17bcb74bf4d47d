#include "tests/bench/ghost_oracle.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

namespace hdr::bench {
namespace {

constexpr float kLikeness = 0.01f;  ///< relative difference from which two radiances are two
constexpr int kReach = 2;           ///< pixels that resampling mixes

/// 1 where the truth of a shot differs from that of the moment, or does within kReach.
Image<std::uint8_t> differs(const Image<float>& shot, const Image<float>& moment) {
  const auto [width, height] = shot.size();
  Image<std::uint8_t> out(shot.size(), 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (std::abs(shot(x, y, 1) - moment(x, y, 1)) <= kLikeness * moment(x, y, 1)) continue;
      for (int v = std::max(0, y - kReach); v <= std::min(height - 1, y + kReach); ++v) {
        for (int u = std::max(0, x - kReach); u <= std::min(width - 1, x + kReach); ++u) out(u, v) = 1;
      }
    }
  }
  return out;
}

Photo copy_of(const Photo& photo) {
  Photo copy{photo.path, photo.exposure, photo.bits, photo.lossy, {}, photo.source};
  std::visit([&](const auto& codes) { copy.codes = codes.clone(); }, photo.codes);
  return copy;
}

/// The merges of the sets of shots that are asked for, each made once.
class SetMerges {
 public:
  SetMerges(const Bracket& bracket, const Alignment& alignment, const Response& response, const MergeOptions& options)
      : bracket_(bracket), alignment_(alignment), response_(response), options_(options) {}

  const Merged& of(std::uint32_t set) {
    const auto found = made_.find(set);
    if (found != made_.end()) return found->second;
    Bracket some;
    Alignment alignment;
    const auto count = static_cast<int>(bracket_.shots.size());
    for (int k = 0; k < count; ++k) {
      if (!(set >> k & 1)) continue;
      some.input_order.push_back(static_cast<int>(some.shots.size()));
      if (k <= alignment_.reference) alignment.reference = static_cast<int>(some.shots.size());
      some.shots.push_back(copy_of(bracket_.shots[static_cast<std::size_t>(k)]));
      alignment.frames.push_back(alignment_.frames[static_cast<std::size_t>(k)]);
    }
    return made_.emplace(set, merge(some, alignment, response_, options_)).first->second;
  }

 private:
  const Bracket& bracket_;
  const Alignment& alignment_;
  const Response& response_;
  const MergeOptions& options_;
  std::map<std::uint32_t, Merged> made_;
};

}  // namespace

std::vector<std::uint32_t> shots_that_show(const test::MovingScene& scene, std::size_t moment) {
  const Size size = scene.truths[0].size();
  std::vector<std::uint32_t> sets(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
  for (std::size_t k = 0; k + 1 < scene.truths.size(); ++k) {
    const Image<std::uint8_t> other = differs(scene.truths[k + 1], scene.truths[moment]);
    std::size_t pixel = 0;
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) sets[pixel++] |= std::uint32_t{other(x, y) == 0} << k;
    }
  }
  return sets;
}

Oracle oracle_of(const Bracket& bracket, const Alignment& alignment, const test::MovingScene& scene,
                 const test::MoverPlan& plan, MergeOptions options) {
  options.deghost = false;
  options.uncertainty = true;
  SetMerges merges(bracket, alignment, plan.response, options);
  const auto [width, height] = plan.size;
  Image<float> best(plan.size, 3), deviation(plan.size, 1);
  for (int y = 0; y < height; ++y) std::fill_n(deviation.row(y), width, INFINITY);
  Oracle oracle{INFINITY, 0};
  for (std::size_t moment = 0; moment < scene.truths.size(); ++moment) {
    const std::vector<std::uint32_t> sets = shots_that_show(scene, moment);
    Image<float> map(plan.size, 3);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const std::uint32_t set = sets[static_cast<std::size_t>(y * width + x)];
        // No shot shows it: a moment that cannot be shown whole. Its error is that of radiance 2^-30.
        std::fill_n(map.pixel(x, y), 3, 0x1p-30f);
        if (set == 0) continue;
        const Merged& merged = merges.of(set);
        for (int c = 0; c < 3; ++c) map(x, y, c) = merged.map.rgb(x, y, c);
        const float relative = merged.map.stddev(x, y, 1) / merged.map.rgb(x, y, 1);
        if (!(relative < deviation(x, y))) continue;
        deviation(x, y) = relative;
        for (int c = 0; c < 3; ++c) best(x, y, c) = map(x, y, c);
      }
    }
    oracle.one_moment = std::min(oracle.one_moment, test::error_quantile(test::closest_errors(map, scene, plan), 0.99));
  }
  oracle.any_moment = test::error_quantile(test::closest_errors(best, scene, plan), 0.99);
  return oracle;
}

}  // namespace hdr::bench
