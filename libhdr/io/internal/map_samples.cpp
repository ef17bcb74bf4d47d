#include "libhdr/io/internal/map_samples.h"

#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/io/internal/oiio.h"

namespace hdr::internal {
namespace {

/// Copies one channel of `all` into one channel of `plane`.
void copy_channel(const Image<float>& all, int from, Image<float>& plane, int to) {
  for_rows(all.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < all.width(); ++x) plane(x, y, to) = all(x, y, from);
    }
  });
}

}  // namespace

ChannelPlan plan_channels(const OIIO::ImageSpec& spec, const Path& path) {
  ChannelPlan plan;
  plan.rgb = {spec.channelindex("R"), spec.channelindex("G"), spec.channelindex("B")};
  plan.alpha = spec.channelindex("A");
  plan.stddev = {spec.channelindex("stddev.R"), spec.channelindex("stddev.G"), spec.channelindex("stddev.B")};
  const int found = (plan.rgb[0] >= 0) + (plan.rgb[1] >= 0) + (plan.rgb[2] >= 0);
  if (found == 3) return plan;
  if (found > 0) {
    plan.note = "some of the channels R, G, B are missing and count as 0";
    return plan;
  }
  const int luminance = spec.channelindex("Y");
  if (luminance >= 0 || spec.nchannels <= 2) {
    const int grey = luminance >= 0 ? luminance : 0;
    plan.rgb = {grey, grey, grey};
    plan.note = "luminance only, repeated as grey";
    return plan;
  }
  std::string names;
  for (const std::string& name : spec.channelnames) names += (names.empty() ? "" : ", ") + name;
  throw Error(
      fmt::format("{}: no channels R, G, B or Y among {}; give a file with colour channels", path.string(), names));
}

void read_samples(OIIO::ImageInput& input, const ChannelPlan& plan, const Path& path, RadianceMap& map) {
  const OIIO::ImageSpec& spec = input.spec();
  Image<float> all = read_floats(input, path);
  if (spec.nchannels == 3 && plan.rgb == std::array{0, 1, 2}) {  // the usual file has R, G, B and nothing else
    map.rgb = std::move(all);
    return;
  }
  map.rgb = Image<float>(all.size(), 3);
  for (int c = 0; c < 3; ++c) {
    if (plan.rgb[static_cast<std::size_t>(c)] >= 0)
      copy_channel(all, plan.rgb[static_cast<std::size_t>(c)], map.rgb, c);
  }
  if (plan.alpha >= 0) {
    map.alpha = Image<float>(map.size(), 1);
    copy_channel(all, plan.alpha, map.alpha, 0);
  }
  const auto& deviation = plan.stddev;
  if (deviation[0] >= 0 && deviation[1] >= 0 && deviation[2] >= 0) {
    map.stddev = Image<float>(map.size(), 3);
    for (int c = 0; c < 3; ++c) copy_channel(all, deviation[static_cast<std::size_t>(c)], map.stddev, c);
  }
}

}  // namespace hdr::internal
