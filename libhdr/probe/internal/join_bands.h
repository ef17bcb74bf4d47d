#pragma once
// What all joins of several pictures to one sphere share: each picture is resampled a band of rows at a time, and
// beside the result only bands are held.
#include <algorithm>
#include <optional>

#include "libhdr/core/parallel.h"
#include "libhdr/core/radiance.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/seam_cut.h"
#include "libhdr/probe/projection.h"
#include "libhdr/probe/unwrap.h"

namespace hdr::internal {

inline constexpr int kBand = 4 * Resampler::kGrain;  ///< rows

/// A map in `to`, written by rows. `sources` are pointers to what has read(first, count); make_joiner(map) is called
/// for each block of rows, and gives a function of (top, y) that writes row y of the band which begins at row top, and
/// says whether all of it is shown: alpha is empty when all rows are. `doubts`: whether there are deviations to be
/// written.
template <class Sources, class MakeJoiner>
RadianceMap join_in_bands(const Sources& sources, const Projection& to, Size size, int channels, bool doubts,
                          const MakeJoiner& make_joiner) {
  RadianceMap map;
  map.rgb = Image<float>(size, channels);
  map.alpha = Image<float>(size, 1);
  if (doubts) map.stddev = Image<float>(size, channels);
  map.projection = text_from_projection(to);
  int whole = 1;
  const auto and_all = [](int& total, int part) { total &= part; };
  for (int top = 0; top < size.height; top += kBand) {
    const int count = std::min(kBand, size.height - top);
    for (const auto& source : sources) source->read(top, count);
    const auto join_rows = [&](int first, int last) {
      auto join = make_joiner(map);
      int all = 1;
      for (int y = first; y < last; ++y) all &= join(top, y) ? 1 : 0;
      return all;
    };
    whole = reduce_rows(count, 4, whole, join_rows, and_all);
  }
  if (whole == 1) map.alpha = {};
  return map;
}

/// Size of the lat-long on which a graph cut is made for a result of `width` columns.
inline Size seam_size(int width) {
  const int columns = std::min(width, 640);
  return {columns, std::max(2, columns / 2)};
}

/// What a source shows of one direction to a graph cut.
struct SeamPixel {
  float cost;        ///< 0..1, as SeamLayer's
  float scale;       ///< from its light to that of all layers
  const float* rgb;  ///< its light
};

/// A source's layer; pixel_of(dir, x, y) says what it shows at a pixel of its band, or nothing.
template <class Source, class PixelOf>
SeamLayer seam_layer(Source& source, Size size, const PixelOf& pixel_of) {
  SeamLayer layer{Image<float>(size, 3), Image<float>(size, 1), Image<float>(size, 1)};
  for (int top = 0; top < size.height; top += kBand) {
    const int count = std::min(kBand, size.height - top);
    source.read(top, count);
    for (int y = 0; y < count; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const Vec3 dir = dir_from_latlong((x + 0.5) / size.width, (top + y + 0.5) / size.height);
        const std::optional<SeamPixel> pixel = pixel_of(dir, x, y);
        if (!pixel) continue;
        layer.shown(x, top + y) = 1;
        layer.cost(x, top + y) = pixel->cost;
        for (int c = 0; c < 3; ++c) layer.rgb(x, top + y, c) = pixel->scale * pixel->rgb[c];
      }
    }
  }
  return layer;
}

}  // namespace hdr::internal
