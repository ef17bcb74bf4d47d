// With T what all unclipped and clipped pixels give a normal now, R_k what region k gives, B the reading, the unknowns
// are h_k = gain - 1 >= 0 of each region and channel and the readings' scale s:
//   least sum over readings and channels of ((s B - sum of h_k R_k - T) / B)^2,  h_k >= 0.
// A pull a hundred thousand times weaker than the readings towards what all regions alike would take decides where the
// readings do not.
#include "libhdr/light/restore_clipped.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libhdr/light/internal/components.h"
#include "libhdr/light/internal/nnls.h"
#include "libhdr/light/internal/region_irradiance.h"

namespace hdr {
namespace {

constexpr std::size_t kMostGroups = 48;
constexpr double kPull = 1e-10;

// Regions with a gain of their own, and one group of all others.
std::vector<std::vector<std::size_t>> groups_of(View<const float> map, const std::vector<Region>& regions) {
  std::vector<double> light;
  for (const Region& region : regions) {
    double sum = 0;
    for (const std::int32_t cell : region) {
      const float* p = map.pixel(cell % map.width(), cell / map.width());
      sum += static_cast<double>(p[0]) + p[1] + p[2];
    }
    light.push_back(sum);
  }
  std::vector<std::size_t> order(regions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return light[a] > light[b]; });
  std::vector<std::vector<std::size_t>> groups;
  for (const std::size_t k : order) {
    if (groups.size() < kMostGroups) {
      groups.push_back({k});
    } else {
      groups.back().push_back(k);
    }
  }
  return groups;
}

// Relative to the readings: rows are readings, one channel.
struct Rows {
  Eigen::MatrixXd groups;  // what each group gives
  Eigen::VectorXd now;     // what all give
};

class Fit {
 public:
  Fit(std::vector<Rows> channels, bool unknown_scale)
      : channels_(std::move(channels)), unknown_scale_(unknown_scale), groups_(channels_[0].groups.cols()) {
    solve(true);
    if (readings() > 1 && groups_ > 1) solve(false);
  }

  double gain(int channel, Eigen::Index group) const { return 1 + x_[index(channel, group)]; }
  double deviation(int channel, Eigen::Index group) const {
    return noise_ * std::sqrt(variance_[index(channel, group)]);
  }
  double scale() const { return unknown_scale_ ? x_[3 * groups_] : 1; }
  double scale_deviation() const { return unknown_scale_ ? noise_ * std::sqrt(variance_[3 * groups_]) : 0; }

  // s - sum - T of each reading.
  Eigen::VectorXd left(int channel) const {
    const Rows& rows = channels_[static_cast<std::size_t>(channel)];
    return Eigen::VectorXd::Constant(readings(), scale()) - rows.now -
           rows.groups * x_.segment(channel * groups_, groups_);
  }

 private:
  Eigen::Index readings() const { return channels_[0].now.size(); }
  Eigen::Index index(int channel, Eigen::Index group) const { return channel * groups_ + group; }

  // All groups by one number a channel, or each by its own.
  void solve(bool alike) {
    const Eigen::Index each = alike ? 1 : groups_, unknowns = 3 * each + (unknown_scale_ ? 1 : 0), rows = readings();
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    for (Eigen::Index c = 0; c < 3; ++c) {
      const Rows& channel = channels_[static_cast<std::size_t>(c)];
      Eigen::MatrixXd a = Eigen::MatrixXd::Zero(rows, unknowns);
      a.middleCols(c * each, each) = alike ? Eigen::MatrixXd(channel.groups.rowwise().sum()) : channel.groups;
      if (unknown_scale_) a.col(3 * each).setConstant(-1);
      const Eigen::VectorXd b = Eigen::VectorXd::Constant(rows, unknown_scale_ ? 0 : 1) - channel.now;
      normal += a.transpose() * a;
      right += a.transpose() * b;
    }
    const double largest = std::max(1e-300, normal.diagonal().maxCoeff());
    for (Eigen::Index k = 0; k < 3 * each; ++k) {
      const double pull = kPull * normal(k, k) + 1e-20 * largest;
      if (!alike) right[k] += pull * x_[k];
      normal(k, k) += pull;
    }
    const NonNegative solution = non_negative_least_squares(normal, right);
    const auto keep = [&](const Eigen::VectorXd& from, Eigen::VectorXd& to) {
      to.resize(3 * groups_ + 1);
      for (Eigen::Index c = 0; c < 3; ++c)
        for (Eigen::Index k = 0; k < groups_; ++k) to[index(static_cast<int>(c), k)] = from[c * each + (alike ? 0 : k)];
      to[3 * groups_] = unknown_scale_ ? from[3 * each] : 1;
    };
    keep(solution.x, x_);
    keep(solution.variance, variance_);
    double squares = 0;
    for (int c = 0; c < 3; ++c) squares += left(c).squaredNorm();
    noise_ = std::sqrt(squares / std::max<double>(1, static_cast<double>(3 * rows - unknowns)));
  }

  std::vector<Rows> channels_;
  bool unknown_scale_;
  Eigen::Index groups_;
  Eigen::VectorXd x_, variance_;  // gains - 1 of the channels' groups, one channel after the other, and the scale
  double noise_ = 0;
};

std::vector<Rows> rows_of(const std::vector<std::vector<Rgb>>& table,
                          const std::vector<std::vector<std::size_t>>& groups,
                          const std::vector<MeasuredIrradiance>& measured) {
  const auto readings = static_cast<Eigen::Index>(measured.size());
  std::vector<Rows> channels;
  for (int c = 0; c < 3; ++c) {
    Rows rows{Eigen::MatrixXd::Zero(readings, static_cast<Eigen::Index>(groups.size())), Eigen::VectorXd(readings)};
    for (Eigen::Index i = 0; i < readings; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double reading = std::max(1e-300, measured[at].irradiance[c]);
      rows.now[i] = table[at].back()[c] / reading;
      for (std::size_t g = 0; g < groups.size(); ++g)
        for (const std::size_t k : groups[g]) rows.groups(i, static_cast<Eigen::Index>(g)) += table[at][k][c] / reading;
      rows.now[i] += rows.groups.row(i).sum();
    }
    channels.push_back(std::move(rows));
  }
  return channels;
}

}  // namespace

Image<std::uint8_t> clipped_mask(View<const float> latlong, double level) {
  HDR_ASSERT(latlong.channels() == 3);
  double limit = level;
  if (!(level > 0)) {
    for (int y = 0; y < latlong.height(); ++y)
      limit = std::max<double>(limit, *std::max_element(latlong.row(y), latlong.row(y) + 3 * latlong.width()));
    limit *= 0.98;
  }
  Image<std::uint8_t> mask(latlong.size(), 1);
  for (int y = 0; y < latlong.height(); ++y) {
    for (int x = 0; x < latlong.width(); ++x) {
      const float* p = latlong.pixel(x, y);
      mask(x, y) = limit > 0 && std::max({p[0], p[1], p[2]}) >= limit;
    }
  }
  return mask;
}

Restored restore_clipped(View<const float> latlong, View<const std::uint8_t> clipped,
                         const std::vector<MeasuredIrradiance>& measured, const RestoreOptions& options) {
  HDR_ASSERT(latlong.channels() == 3 && clipped.size() == latlong.size());
  if (measured.empty()) throw Error("no irradiance was measured; give a lux meter's reading or normals of a ball");
  std::vector<std::uint8_t> inside;
  for (int y = 0; y < clipped.height(); ++y)
    inside.insert(inside.end(), clipped.row(y), clipped.row(y) + clipped.width());
  const std::vector<Region> regions = connected_components(inside, clipped.size());
  if (regions.empty()) throw Error("nothing in the map is clipped; lower the level from which pixels count as clipped");
  std::vector<Vec3> normals;
  for (const MeasuredIrradiance& m : measured) normals.push_back(m.normal.normalized());
  const auto groups = groups_of(latlong, regions);
  const Fit fit(rows_of(region_irradiance(latlong, regions, normals), groups, measured), options.unknown_scale);

  Restored result;
  result.regions = static_cast<int>(regions.size());
  result.gains.resize(regions.size());
  result.deviations.resize(regions.size());
  result.scale = fit.scale();
  result.scale_deviation = fit.scale_deviation();
  for (int c = 0; c < 3; ++c) {
    result.residual[c] =
        std::sqrt(fit.left(c).squaredNorm() / static_cast<double>(measured.size())) / std::max(1e-300, fit.scale());
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (const std::size_t k : groups[g]) {
        result.gains[k][c] = fit.gain(c, static_cast<Eigen::Index>(g));
        result.deviations[k][c] = fit.deviation(c, static_cast<Eigen::Index>(g));
      }
    }
  }
  result.rgb = Image<float>(latlong.size(), 3);
  for (int y = 0; y < latlong.height(); ++y) std::copy_n(latlong.row(y), 3 * latlong.width(), result.rgb.row(y));
  for (std::size_t k = 0; k < regions.size(); ++k) {
    for (const std::int32_t cell : regions[k]) {
      float* p = result.rgb.pixel(cell % latlong.width(), cell / latlong.width());
      for (int c = 0; c < 3; ++c) p[c] = static_cast<float>(p[c] * result.gains[k][c]);
    }
  }
  return result;
}

}  // namespace hdr
