// The fast merge of a row means what the obvious one says, to the bit.
#include "libhdr/merge/internal/merge_row.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "libhdr/core/random.h"
#include "libhdr/merge/internal/merge_model.h"

namespace hdr::internal {
namespace {

struct Rows {
  std::vector<std::vector<std::uint8_t>> codes;
  std::vector<WarpedRow> warped;
  std::vector<std::vector<float>> trust;
  std::vector<ShotRow> shots;
};

/// 0, 1 or something between, for a whole number of tiles.
std::vector<float> made_up_trust(int width, Random& random) {
  std::vector<float> trust;
  for (int x = 0; x < (width + kTile - 1) / kTile * kTile; ++x) {
    trust.push_back(std::clamp(1.5f * random.uniform_float() - 0.25f, 0.0f, 1.0f));
  }
  return trust;
}

/// Shots of a ramp with noise; every second one is a row that was resampled, and lies partly outside. With `doubts` the
/// pixels of most shots are trusted by halves.
Rows made_up(const MergeModel& model, int width, std::uint64_t seed, bool doubts) {
  constexpr int kShots = 5;
  Rows rows;
  rows.codes.resize(kShots);
  rows.warped.assign(kShots, WarpedRow(width));
  for (int j = 0; j < kShots; ++j) {
    const auto shot = static_cast<std::size_t>(j);
    Random random(seed, shot);
    const float exposure = std::exp2f(static_cast<float>(2 * j - 4));
    WarpedRow& row = rows.warped[shot];
    for (int k = 0; k < 3 * width; ++k) {
      const double light = 255 * exposure * std::exp2(12.0 * k / (3 * width) - 8) * (1 + 0.05 * random.normal());
      const auto code = static_cast<std::size_t>(std::clamp(light, 0.0, 255.0));
      const auto c = static_cast<std::size_t>(k % 3), x = static_cast<std::size_t>(k / 3);
      const bool outside = k / 3 % 7 == j;
      rows.codes[shot].push_back(static_cast<std::uint8_t>(code));
      row.level[c][x] = outside || model.hat ? -1 : model.channel[c].level[code];
      row.information[c][x] = 1 + 1.5f * random.uniform_float();
      row.trust[c][x] = random.uniform() < 0.2 ? 1e-4f : 1 - random.uniform_float();
      row.closes[c][x] = !outside && static_cast<int>(code) >= model.closing_code;
      if (!model.hat) continue;
      row.weight[c][x] = outside ? 0 : model.channel[c].weight[code];
      row.weight_light[c][x] = outside ? 0 : model.channel[c].weight_light[code];
    }
    const bool warped = j % 2 == 1;
    rows.trust.push_back(made_up_trust(width, random));
    rows.shots.push_back({warped ? nullptr : rows.codes[shot].data(), warped ? &row : nullptr, exposure});
    if (doubts && j != 1) rows.shots.back().trust = rows.trust.back().data();
  }
  return rows;
}

void expect_same_bits(const std::vector<float>& obvious, const std::vector<float>& vectors, const std::string& what) {
  for (std::size_t k = 0; k < obvious.size(); ++k) {
    if (std::memcmp(&obvious[k], &vectors[k], sizeof(float)) == 0) continue;
    FAIL() << fmt::format(
        "{}: sample {} is {} and {}; was a product fused with a sum, or a sum taken in another order?", what, k,
        obvious[k], vectors[k]);
  }
}

TEST(MergeRow, OfVectorsIsThatOfTheObviousVersion) {
  for (const bool lossy : {false, true}) {
    for (const WeightKind kind : {WeightKind::kHat, WeightKind::kVariance}) {
      const MergeModel model = make_merge_model(gamma_response(8, 2.2), {lossy, kind, {}, {}, {}});
      for (int variant = 0; variant < 8; ++variant) {
        const int widths[] = {1, 63, 64, 200}, width = widths[variant % 4];
        const bool doubts = variant >= 4;
        const Rows rows = made_up(model, width, static_cast<std::uint64_t>(width), doubts);
        const auto samples = static_cast<std::size_t>(3 * width);
        std::vector<float> rgb[2], stddev[2];
        std::vector<std::uint8_t> unmeasured[2];
        for (int k = 0; k < 2; ++k) {
          rgb[k].resize(samples);
          stddev[k].resize(samples);
          unmeasured[k].resize(samples);
          MergeRowTask task{&model, rows.shots.data(), static_cast<int>(rows.shots.size()), width};
          task.rgb = rgb[k].data();
          task.stddev = stddev[k].data();
          task.unmeasured = unmeasured[k].data();
          MergeRowScratch scratch;
          if (k == 0) {
            reference::merge_row(task);
          } else {
            merge_row(task, scratch);
          }
        }
        const std::string where =
            fmt::format("{}, {}, width {}, {}", lossy ? "lossy" : "lossless",
                        kind == WeightKind::kHat ? "hat" : "likelihood", width, doubts ? "doubts" : "full trust");
        expect_same_bits(rgb[0], rgb[1], "radiance, " + where);
        expect_same_bits(stddev[0], stddev[1], "standard deviation, " + where);
        EXPECT_EQ(unmeasured[0], unmeasured[1]) << where;
      }
    }
  }
}

}  // namespace
}  // namespace hdr::internal
