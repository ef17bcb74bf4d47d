#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/join_bands.h"
#include "libhdr/probe/stitch.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

using internal::kBand;
constexpr double kSharpness = 6;      ///< of the border between two photographs
constexpr double kDisagreement = 4;   ///< times as sharp where they show different things
constexpr double kClippedSay = 1e-6;  ///< of a clipped pixel's weight

/// One photograph, resampled a band at a time.
struct Source {
  const StitchPhoto* photo;
  const StitchedPhoto* view;
  Mat3 view_from_probe;
  Resampler rgb;
  std::optional<Resampler> alpha;
  Image<float> rgb_band, alpha_band, stddev_band;

  Source(const StitchPhoto& given, const StitchedPhoto& solved, Size size, const Mat3& stitch_from_probe)
      : photo(&given),
        view(&solved),
        view_from_probe(solved.probe_from_view.transpose() * stitch_from_probe),
        rgb(given.rgb, solved.lens, LatLong{size}, size, view_from_probe, given.stddev),
        rgb_band(size.width, kBand, 3) {
    if (!given.alpha.empty()) {
      alpha.emplace(given.alpha, solved.lens, LatLong{size}, size, view_from_probe);
      alpha_band = Image<float>(size.width, kBand, 1);
    }
    if (!given.stddev.empty()) stddev_band = Image<float>(size.width, kBand, 3);
  }

  void read(int first, int count) {
    const auto rows = [&](Image<float>& band) { return band.empty() ? View<float>() : band.view().rows(0, count); };
    rgb.rows(first, {rows(rgb_band), {}, rows(stddev_band)});
    if (alpha) alpha->rows(first, rows(alpha_band));
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

using Sources = std::vector<std::unique_ptr<Source>>;

Sources sources_of(const std::vector<StitchPhoto>& photos, const Stitch& stitch, Size size,
                   const Mat3& stitch_from_probe) {
  Sources sources;
  for (std::size_t k = 0; k < photos.size(); ++k) {
    if (!stitch.photos[k].used) continue;
    sources.push_back(std::make_unique<Source>(photos[k], stitch.photos[k], size, stitch_from_probe));
  }
  return sources;
}

/// The photographs' parts of the sphere. What is clipped, or near a photograph's border, is used where there is nothing
/// better.
internal::SeamCut cut(const std::vector<StitchPhoto>& photos, const Stitch& stitch, int width,
                      const Mat3& stitch_from_probe) {
  const Size size = internal::seam_size(width);
  std::vector<internal::SeamLayer> layers;
  for (auto& source : sources_of(photos, stitch, size, stitch_from_probe)) {
    const auto pixel_of = [&](const Vec3& dir, int x, int y) -> std::optional<internal::SeamPixel> {
      const auto say = say_of(*source, stitch.vignetting, dir, x, y);
      if (!say) return std::nullopt;
      return internal::SeamPixel{say->clipped ? 1.0f : static_cast<float>(0.2 * (1 - say->weight)),
                                 static_cast<float>(say->scale), source->rgb_band.pixel(x, y)};
    };
    layers.push_back(internal::seam_layer(*source, size, pixel_of));
  }
  return internal::SeamCut(layers);
}

/// Weights sum to 1: the parts that the cut gave, and where it gave none the rest.
void share_by_cut(std::vector<Say>& says, const std::vector<std::size_t>& which, const internal::SeamCut& seams,
                  const Vec2& uv) {
  double total = 0;
  for (std::size_t i = 0; i < says.size(); ++i) {
    constexpr double kElse = 1e-6;
    const double share = seams.share(which[i], uv) * (says[i].clipped ? kClippedSay : 1);
    total += says[i].weight = share + kElse * says[i].weight;
  }
  for (Say& say : says) say.weight /= total;
}

/// Joins bands of the sphere.
class Joiner {
 public:
  Joiner(const Sources& sources, const Stitch& stitch, const std::optional<internal::SeamCut>& seams, RadianceMap& map)
      : sources_(sources), stitch_(stitch), seams_(seams), map_(map) {}

  /// Row `y` of the band that begins at row `top`; whether all of it is shown.
  bool join(int top, int y) {
    const double most_log_ratio = std::max(0.15, 4 * stitch_.overlap_rms);
    const Size size = map_.rgb.size();
    bool all = true;
    for (int x = 0; x < size.width; ++x) {
      const Vec2 uv((x + 0.5) / size.width, (top + y + 0.5) / size.height);
      const Vec3 dir = dir_from_latlong(uv.x(), uv.y());
      says_.clear();
      which_.clear();
      for (std::size_t k = 0; k < sources_.size(); ++k) {
        const auto say = say_of(*sources_[k], stitch_.vignetting, dir, x, y);
        if (!say) continue;
        says_.push_back(*say);
        which_.push_back(k);
      }
      all &= !says_.empty();
      if (says_.empty()) continue;
      keep_greatest_bound(says_);
      if (seams_ && says_.size() > 1) {
        share_by_cut(says_, which_, *seams_, uv);
      } else {
        share_out(says_, most_log_ratio);
      }
      map_.alpha(x, top + y) = 1;
      write(x, y, top + y);
    }
    return all;
  }

 private:
  void write(int x, int band_y, int y) {
    for (int c = 0; c < 3; ++c) {
      double sum = 0, variance = 0;
      for (const Say& say : says_) {
        const double w = say.weight * say.scale;
        sum += w * static_cast<double>(say.source->rgb_band(x, band_y, c));
        if (map_.stddev.empty()) continue;
        const double deviation = w * static_cast<double>(say.source->stddev_band(x, band_y, c));
        variance += deviation * deviation;
      }
      map_.rgb(x, y, c) = static_cast<float>(sum);
      if (!map_.stddev.empty()) map_.stddev(x, y, c) = static_cast<float>(std::sqrt(variance));
    }
  }

  const Sources& sources_;
  const Stitch& stitch_;
  const std::optional<internal::SeamCut>& seams_;
  RadianceMap& map_;
  std::vector<Say> says_;
  std::vector<std::size_t> which_;
};

}  // namespace

RadianceMap merge_stitch(const std::vector<StitchPhoto>& photos, const Stitch& stitch, int width,
                         const Mat3& stitch_from_probe, Seam seam) {
  HDR_ASSERT(photos.size() == stitch.photos.size() && width > 1);
  const Size size{width, width / 2};
  std::optional<internal::SeamCut> seams;
  if (seam == Seam::kCut) seams.emplace(cut(photos, stitch, width, stitch_from_probe));
  const Sources sources = sources_of(photos, stitch, size, stitch_from_probe);
  const bool doubts =
      std::none_of(sources.begin(), sources.end(), [](const auto& s) { return s->stddev_band.empty(); });
  return internal::join_in_bands(sources, LatLong{size}, size, 3, doubts, [&](RadianceMap& map) {
    return [joiner = Joiner(sources, stitch, seams, map)](int top, int y) mutable { return joiner.join(top, y); };
  });
}

}  // namespace hdr
