#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/probe/ball_views.h"
#include "libhdr/probe/internal/ball_sphere.h"
#include "libhdr/probe/internal/join_bands.h"

namespace hdr {
namespace {

/// The weight of a view in a direction: the square of the cosine of incidence, as detail and area go, and next to
/// nothing where the photographer may stand.
double weight_of(const BallView& view, const Vec3& dir) {
  constexpr double kLeast = 1e-4;  // where no other view shows the place, he stays
  const double seen = internal::visibility(view, dir);
  return seen * seen * (kLeast + (1 - kLeast) * internal::nobody_there(view, dir));
}

/// Whether views that both have a say differ by more than their registration explains.
bool disagree(const std::vector<double>& weights, const std::vector<double>& light, double most_log_ratio) {
  constexpr double kHasASay = 0.05;
  const double heaviest = *std::max_element(weights.begin(), weights.end());
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] < kHasASay * heaviest) continue;
    least = std::min(least, light[k]);
    most = std::max(most, light[k]);
  }
  return most > least * std::exp(most_log_ratio);
}

using internal::kBand;

/// One view, resampled a band at a time.
struct Source {
  BallView view;
  double gain;
  Mat3 view_from_probe;
  Resampler resampler;
  Image<float> rgb, stddev;

  Source(const BallView& given, const RegisteredView& registered, const Projection& to, Size size,
         const Mat3& first_from_probe)
      : view(with_ball(given, registered.ball)),
        gain(registered.gain),
        view_from_probe(registered.probe_from_view.transpose() * first_from_probe),
        resampler(given.rgb, registered.ball, to, size, view_from_probe, given.stddev),
        rgb(size.width, kBand, given.rgb.channels()) {
    if (!given.stddev.empty()) stddev = Image<float>(size.width, kBand, given.stddev.channels());
  }
  static BallView with_ball(BallView view, const MirrorBall& ball) {
    view.ball = ball;
    return view;
  }

  void read(int first, int count) {
    resampler.rows(first,
                   {rgb.view().rows(0, count), {}, stddev.empty() ? View<float>() : stddev.view().rows(0, count)});
  }
};

/// Joins rows of bands.
class Joiner {
 public:
  Joiner(const std::vector<std::unique_ptr<Source>>& sources, const Projection& to, double most_log_ratio,
         RadianceMap& map)
      : sources_(sources),
        to_(to),
        most_log_ratio_(most_log_ratio),
        map_(map),
        weights_(sources.size()),
        light_(sources.size()) {}

  /// Row `y` of the band that begins at row `top`; whether all of what it has room for is shown.
  bool join(int top, int y) {
    bool all = true;
    for (int x = 0; x < map_.rgb.width(); ++x) {
      const auto dir = dir_from_px(to_, {x + 0.5, top + y + 0.5});
      if (!dir) continue;
      for (std::size_t k = 0; k < sources_.size(); ++k) {
        const Source& source = *sources_[k];
        weights_[k] = weight_of(source.view, source.view_from_probe * *dir);
        const float* p = source.rgb.pixel(x, y);
        light_[k] = source.gain * static_cast<double>(luminance(p[0], p[1], p[2]));
      }
      if (disagree(weights_, light_, most_log_ratio_)) {
        for (double& w : weights_) w *= w * w * w;
      }
      const double total = std::accumulate(weights_.begin(), weights_.end(), 0.0);
      all &= total > 0;
      if (total > 0) write(x, y, top + y, total);
    }
    return all;
  }

 private:
  void write(int x, int band_y, int y, double total) {
    map_.alpha(x, y) = 1;
    for (int c = 0; c < map_.rgb.channels(); ++c) {
      double sum = 0, variance = 0;
      for (std::size_t k = 0; k < sources_.size(); ++k) {
        const double w = weights_[k] / total * sources_[k]->gain;
        sum += w * static_cast<double>(sources_[k]->rgb(x, band_y, c));
        if (map_.stddev.empty()) continue;
        const double deviation = w * static_cast<double>(sources_[k]->stddev(x, band_y, c));
        variance += deviation * deviation;
      }
      map_.rgb(x, y, c) = static_cast<float>(sum);
      if (!map_.stddev.empty()) map_.stddev(x, y, c) = static_cast<float>(std::sqrt(variance));
    }
  }

  const std::vector<std::unique_ptr<Source>>& sources_;
  const Projection& to_;
  double most_log_ratio_;
  RadianceMap& map_;
  std::vector<double> weights_, light_;
};

}  // namespace

RadianceMap join_ball_views(const std::vector<BallView>& views, const std::vector<RegisteredView>& registered,
                            const Projection& to, Size size, const Mat3& first_from_probe) {
  HDR_ASSERT(!views.empty() && views.size() == registered.size());
  std::vector<std::unique_ptr<Source>> sources;
  double most_log_ratio = 0.4;
  bool doubts = true;
  for (std::size_t k = 0; k < views.size(); ++k) {
    sources.push_back(std::make_unique<Source>(views[k], registered[k], to, size, first_from_probe));
    most_log_ratio = std::max(most_log_ratio, 4 * registered[k].overlap_rms);
    doubts &= !views[k].stddev.empty();
  }
  return internal::join_in_bands(sources, to, size, views.front().rgb.channels(), doubts, [&](RadianceMap& map) {
    return [joiner = Joiner(sources, to, most_log_ratio, map)](int top, int y) mutable { return joiner.join(top, y); };
  });
}

}  // namespace hdr
