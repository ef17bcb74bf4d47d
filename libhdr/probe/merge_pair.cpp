#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/fisheye_pair.h"
#include "libhdr/probe/internal/join_bands.h"
#include "libhdr/probe/internal/overlap_ring.h"

namespace hdr {
namespace {

using namespace internal;

/// One photograph, resampled a band at a time.
struct Source {
  const PairView* view;
  Mat3 view_from_probe;
  Resampler resampler;
  Image<float> rgb, shown, stddev;

  Source(const PairPhoto& photo, const PairView& pair_view, Size size, const Mat3& pair_from_probe)
      : view(&pair_view),
        view_from_probe(pair_view.probe_from_view.transpose() * pair_from_probe),
        resampler(photo.rgb, pair_view.lens, LatLong{size}, size, view_from_probe, photo.stddev),
        rgb(size.width, kBand, 3),
        shown(size.width, kBand, 1) {
    if (!photo.stddev.empty()) stddev = Image<float>(size.width, kBand, 3);
  }

  void read(int first, int count) {
    const auto rows = [&](Image<float>& band) { return band.empty() ? View<float>() : band.view().rows(0, count); };
    resampler.rows(first, {rows(rgb), rows(shown), rows(stddev)});
  }

  /// Of a direction of the probe, from the lens's axis, in half fields.
  double aside(const Vec3& dir) const {
    const Vec3 d = view_from_probe * dir;
    return std::atan2(std::hypot(d.x(), d.y()), d.z()) / (0.5 * view->lens.fov_degrees * kDegree);
  }
};
using Sources = std::array<std::unique_ptr<Source>, 2>;

Sources sources_of(const PairPhoto& front, const PairPhoto& back, const FisheyePair& pair, Size size,
                   const Mat3& pair_from_probe) {
  return {std::make_unique<Source>(front, pair.views[0], size, pair_from_probe),
          std::make_unique<Source>(back, pair.views[1], size, pair_from_probe)};
}

/// The second photograph's share of a direction.
class Border {
 public:
  virtual ~Border() = default;
  virtual double of_back(const Vec3& pair_dir, const Vec2& uv) const = 0;
};

/// Around the ring, along the path on which the two differ least.
class RingBorder : public Border {
 public:
  RingBorder(const PairPhoto& front, const PairPhoto& back, const FisheyePair& pair, double feather_degrees)
      : feather_(std::max(feather_degrees * kDegree, 1e-6)) {
    const Fisheye& lens = pair.views[0].lens;
    ring_ = ring_of(pair.views[0], pair.views[1], 0.5 * lens.disc.r / (0.5 * lens.fov_degrees * kDegree));
    if (ring_.height > 0)
      seam_ = best_seam(unroll(front.rgb, pair.views[0], ring_), unroll(back.rgb, pair.views[1], ring_));
  }

  double of_back(const Vec3& d, const Vec2&) const override {
    const double angle = std::atan2(std::hypot(d.x(), d.y()), d.z());
    double border = 0.5 * kPi;
    if (ring_.height > 0) {
      const double column = ring_.px_of(d).x() - 0.5, left = std::floor(column), part = column - left;
      border = ring_.angle_of_row((1 - part) * row_at(left) + part * row_at(left + 1));
    }
    return std::clamp((angle - border) / feather_ + 0.5, 0.0, 1.0);
  }

 private:
  double row_at(double column) const {
    return seam_[static_cast<std::size_t>((static_cast<int>(column) % ring_.width + ring_.width) % ring_.width)];
  }

  double feather_;
  Ring ring_;
  std::vector<double> seam_;
};

/// Where a graph cut says.
class CutBorder : public Border {
 public:
  CutBorder(const PairPhoto& front, const PairPhoto& back, const FisheyePair& pair, int width,
            const Mat3& pair_from_probe)
      : cut_(layers(front, back, pair, width, pair_from_probe)) {}

  double of_back(const Vec3&, const Vec2& uv) const override { return cut_.share(1, uv); }

 private:
  static std::vector<SeamLayer> layers(const PairPhoto& front, const PairPhoto& back, const FisheyePair& pair,
                                       int width, const Mat3& pair_from_probe) {
    const Size size = seam_size(width);
    std::vector<SeamLayer> result;
    for (auto& source : sources_of(front, back, pair, size, pair_from_probe)) {
      const auto pixel_of = [&](const Vec3& dir, int x, int y) -> std::optional<SeamPixel> {
        const double aside = source->aside(dir);
        if (!(source->shown(x, y) > 0 && aside < 1)) return std::nullopt;
        // A little dearer towards the rim, where each lens is blurred.
        return SeamPixel{static_cast<float>(0.2 * aside), static_cast<float>(source->view->gain),
                         source->rgb.pixel(x, y)};
      };
      result.push_back(seam_layer(*source, size, pixel_of));
    }
    return result;
  }

  SeamCut cut_;
};

/// Writes row `y` of the band that begins at row `top`; whether all of it is shown.
bool join_row(const Sources& sources, const Border& border, const Mat3& pair_from_probe, int top, int y,
              RadianceMap& map) {
  const Size size = map.rgb.size();
  bool all = true;
  for (int x = 0; x < size.width; ++x) {
    const Vec2 uv((x + 0.5) / size.width, (top + y + 0.5) / size.height);
    const Vec3 dir = dir_from_latlong(uv.x(), uv.y());
    double of_back = border.of_back(pair_from_probe * dir, uv);
    // Where only one shows anything it shows all.
    const bool front = sources[0]->shown(x, y) > 0 && sources[0]->aside(dir) <= 1;
    const bool back = sources[1]->shown(x, y) > 0 && sources[1]->aside(dir) <= 1;
    all &= front || back;
    if (!front && !back) continue;
    if (!front) of_back = 1;
    if (!back) of_back = 0;
    map.alpha(x, top + y) = 1;
    const double a = (1 - of_back) * sources[0]->view->gain, b = of_back * sources[1]->view->gain;
    for (int c = 0; c < 3; ++c) {
      map.rgb(x, top + y, c) = static_cast<float>(a * static_cast<double>(sources[0]->rgb(x, y, c)) +
                                                  b * static_cast<double>(sources[1]->rgb(x, y, c)));
      if (map.stddev.empty()) continue;
      map.stddev(x, top + y, c) = static_cast<float>(std::hypot(a * static_cast<double>(sources[0]->stddev(x, y, c)),
                                                                b * static_cast<double>(sources[1]->stddev(x, y, c))));
    }
  }
  return all;
}

}  // namespace

RadianceMap merge_fisheye_pair(const PairPhoto& front, const PairPhoto& back, const FisheyePair& pair, int width,
                               const Mat3& pair_from_probe, const PairMergeOptions& options) {
  require_overlap(pair.views[0].lens, pair.views[1].lens);
  const Size size{width, std::max(1, width / 2)};
  std::unique_ptr<const Border> border;
  if (options.seam == Seam::kCut) {
    border = std::make_unique<CutBorder>(front, back, pair, width, pair_from_probe);
  } else {
    border = std::make_unique<RingBorder>(front, back, pair, options.feather_degrees);
  }
  const Sources sources = sources_of(front, back, pair, size, pair_from_probe);
  const bool doubts = !front.stddev.empty() && !back.stddev.empty();
  return join_in_bands(sources, LatLong{size}, size, 3, doubts, [&](RadianceMap& map) {
    return [&](int top, int y) { return join_row(sources, *border, pair_from_probe, top, y, map); };
  });
}

}  // namespace hdr
