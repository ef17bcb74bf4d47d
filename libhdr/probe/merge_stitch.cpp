#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/stitch.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

constexpr int kBand = 4 * Resampler::kGrain;
constexpr double kSharpness = 6;      ///< of the border between two photographs
constexpr double kDisagreement = 4;   ///< times as sharp where they show different things
constexpr double kClippedSay = 1e-6;  ///< of a clipped pixel's weight

/// One photograph, resampled a band at a time.
struct Source {
  const StitchPhoto* photo;
  const StitchedPhoto* view;
  Mat3 view_from_probe;
  Resampler rgb;
  std::optional<Resampler> alpha, stddev;
  Image<float> rgb_band, alpha_band, stddev_band;

  Source(const StitchPhoto& given, const StitchedPhoto& solved, Size size, const Mat3& stitch_from_probe)
      : photo(&given),
        view(&solved),
        view_from_probe(solved.probe_from_view.transpose() * stitch_from_probe),
        rgb(given.rgb, solved.lens, LatLong{size}, size, view_from_probe),
        rgb_band(size.width, kBand, 3) {
    if (!given.alpha.empty()) {
      alpha.emplace(given.alpha, solved.lens, LatLong{size}, size, view_from_probe);
      alpha_band = Image<float>(size.width, kBand, 1);
    }
    if (!given.stddev.empty()) {
      stddev.emplace(given.stddev, solved.lens, LatLong{size}, size, view_from_probe);
      stddev_band = Image<float>(size.width, kBand, 3);
    }
  }

  void read(int first, int count) {
    rgb.rows(first, rgb_band.view().rows(0, count));
    if (alpha) alpha->rows(first, alpha_band.view().rows(0, count));
    if (stddev) stddev->rows(first, stddev_band.view().rows(0, count));
  }
};

/// What one photograph has to say of a direction.
struct Say {
  double weight = 0;  ///< 1 in the photograph's middle, 0 at its border [Brown07] section 6
  double scale = 0;   ///< its gain over what its lens passed there
  double light = 0;   ///< luminance, scaled
  int x = 0, y = 0;   ///< of its band
  const Source* source = nullptr;
  bool clipped = false;
};

std::optional<Say> say_of(const Source& source, const Vignetting& vignetting, const Vec3& dir, int x, int y) {
  const Vec3 ray = source.view_from_probe * dir;
  if (ray.z() <= 0) return std::nullopt;
  const Rectilinear& lens = source.view->lens;
  const auto px = lens.px_from_dir(ray);
  if (!px) return std::nullopt;
  const double u = 2 * px->x() / lens.size.width - 1, v = 2 * px->y() / lens.size.height - 1;
  Say say{std::max(1e-3, (1 - std::abs(u)) * (1 - std::abs(v))), 0, 0, x, y, &source};
  if (source.alpha) {
    const double alpha = static_cast<double>(source.alpha_band(x, y));
    if (!(alpha > 0.01)) return std::nullopt;
    say.weight *= alpha;
  }
  const Vec2 middle(0.5 * lens.size.width, 0.5 * lens.size.height);
  say.scale = source.view->gain / std::max(0.05, vignetting.at((*px - middle).squaredNorm() / middle.squaredNorm()));
  if (source.alpha) say.scale /= static_cast<double>(source.alpha_band(x, y));
  const float* p = source.rgb_band.pixel(x, y);
  say.light = say.scale * luminance<double>(p[0], p[1], p[2]);
  say.clipped = static_cast<double>(std::max({p[0], p[1], p[2]})) >= source.photo->ceiling;
  if (say.clipped) say.weight *= kClippedSay;
  return say;
}

/// What clipped is at least as bright as it looks: where nothing else is known, the greatest of these bounds holds, and
/// a mean with lower ones would be below it.
void keep_greatest_bound(std::vector<Say>& says) {
  if (!std::all_of(says.begin(), says.end(), [](const Say& say) { return say.clipped; })) return;
  const auto darker = [](const Say& a, const Say& b) { return a.light < b.light; };
  says = {*std::max_element(says.begin(), says.end(), darker)};
}

/// Weights sum to 1.
void share_out(std::vector<Say>& says, double most_log_ratio) {
  double heaviest = 0, least = std::numeric_limits<double>::infinity(), most = 0;
  for (const Say& say : says) heaviest = std::max(heaviest, say.weight);
  for (const Say& say : says) {
    if (say.weight < 0.5 * heaviest) continue;
    least = std::min(least, say.light);
    most = std::max(most, say.light);
  }
  const double power = kSharpness * (most > least * std::exp(most_log_ratio) ? kDisagreement : 1);
  double total = 0;
  for (Say& say : says) total += say.weight = std::pow(say.weight / heaviest, power);
  for (Say& say : says) say.weight /= total;
}

}  // namespace

RadianceMap merge_stitch(const std::vector<StitchPhoto>& photos, const Stitch& stitch, int width,
                         const Mat3& stitch_from_probe) {
  HDR_ASSERT(photos.size() == stitch.photos.size() && width > 1);
  const Size size{width, width / 2};
  std::vector<std::unique_ptr<Source>> sources;
  bool doubts = true;
  for (std::size_t k = 0; k < photos.size(); ++k) {
    if (!stitch.photos[k].used) continue;
    sources.push_back(std::make_unique<Source>(photos[k], stitch.photos[k], size, stitch_from_probe));
    doubts &= sources.back()->stddev.has_value();
  }
  const double most_log_ratio = std::max(0.15, 4 * stitch.overlap_rms);
  RadianceMap map;
  map.rgb = Image<float>(size, 3);
  map.alpha = Image<float>(size, 1);
  if (doubts) map.stddev = Image<float>(size, 3);
  map.projection = LatLong::kName;
  bool whole = true;
  for (int top = 0; top < size.height; top += kBand) {
    const int count = std::min(kBand, size.height - top);
    for (auto& source : sources) source->read(top, count);
    const int band_is_whole = reduce_rows(
        count, 4, 1,
        [&](int first, int last) {
          bool all = true;
          std::vector<Say> says;
          for (int y = first; y < last; ++y) {
            for (int x = 0; x < width; ++x) {
              const Vec3 dir = dir_from_latlong((x + 0.5) / width, (top + y + 0.5) / size.height);
              says.clear();
              for (const auto& source : sources) {
                if (const auto say = say_of(*source, stitch.vignetting, dir, x, y)) says.push_back(*say);
              }
              all &= !says.empty();
              if (says.empty()) continue;
              keep_greatest_bound(says);
              share_out(says, most_log_ratio);
              map.alpha(x, top + y) = 1;
              for (int c = 0; c < 3; ++c) {
                double sum = 0, variance = 0;
                for (const Say& say : says) {
                  const double w = say.weight * say.scale;
                  sum += w * static_cast<double>(say.source->rgb_band(x, y, c));
                  if (!doubts) continue;
                  const double deviation = w * static_cast<double>(say.source->stddev_band(x, y, c));
                  variance += deviation * deviation;
                }
                map.rgb(x, top + y, c) = static_cast<float>(sum);
                if (doubts) map.stddev(x, top + y, c) = static_cast<float>(std::sqrt(variance));
              }
            }
          }
          return all ? 1 : 0;
        },
        [](int& total, int part) { total &= part; });
    whole = whole && band_is_whole == 1;
  }
  if (whole) map.alpha = {};
  return map;
}

}  // namespace hdr
