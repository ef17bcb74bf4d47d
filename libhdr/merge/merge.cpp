#include "libhdr/merge/merge.h"

#include "libhdr/merge/internal/merge_bands.h"

namespace hdr {

using internal::BandViews;

MergeSummary merge_rows(const Bracket& bracket, const Alignment& alignment, const Response& response,
                        const MergeOptions& options, MapSink& sink) {
  const int width = bracket.size().width, height = std::min(internal::kBandHeight, bracket.size().height);
  Image<float> rgb(width, height, 3), stddev;
  Image<std::uint8_t> flags;
  if (options.uncertainty) {
    stddev = Image<float>(width, height, 3);
    flags = Image<std::uint8_t>(width, height, 1);
  }
  BandViews band;
  const auto views = [&](int first, int last) {
    const int rows = last - first;
    band.rgb = rgb.view().rows(0, rows);
    if (options.uncertainty) {
      band.stddev = stddev.view().rows(0, rows);
      band.flags = flags.view().rows(0, rows);
    }
    return band;
  };
  const auto done = [&](int first, int) { sink.put({first, band.rgb, band.stddev, band.flags}); };
  return internal::merge_bands(bracket, alignment, response, options, views, done);
}

Merged merge(const Bracket& bracket, const Alignment& alignment, const Response& response,
             const MergeOptions& options) {
  Merged merged;
  const Size size = bracket.size();
  merged.map.rgb = Image<float>(size, 3);
  if (options.uncertainty) {
    merged.map.stddev = Image<float>(size, 3);
    merged.flags = Image<std::uint8_t>(size, 1);
  }
  const auto views = [&](int first, int last) {
    BandViews band{merged.map.rgb.view().rows(first, last), {}, {}};
    if (options.uncertainty) {
      band.stddev = merged.map.stddev.view().rows(first, last);
      band.flags = merged.flags.view().rows(first, last);
    }
    return band;
  };
  static_cast<MergeSummary&>(merged) =
      internal::merge_bands(bracket, alignment, response, options, views, [](int, int) {});
  return merged;
}

}  // namespace hdr
