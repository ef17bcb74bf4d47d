#pragma once
// Which channels of a file are the radiance, and how they come into a RadianceMap.
#include <OpenImageIO/imageio.h>

#include <array>
#include <string>

#include "libhdr/core/photo.h"
#include "libhdr/core/radiance.h"

namespace hdr::internal {

/// Channel numbers of the file; -1: absent.
struct ChannelPlan {
  std::array<int, 3> rgb{-1, -1, -1};
  int alpha = -1;
  std::array<int, 3> stddev{-1, -1, -1};
  std::string note;  ///< what was missing, in words; empty when all is as usual
};

/// R, G, B by name (absent ones are 0), else Y or the only channel as grey, else the first three of a file without
/// channel names. Throws Error when none of these is there (a depth map, a layer alone).
ChannelPlan plan_channels(const OIIO::ImageSpec& spec, const Path& path);

/// Fills map.rgb, alpha and stddev as float, in the order of the file.
void read_samples(OIIO::ImageInput& input, const ChannelPlan& plan, const Path& path, RadianceMap& map);

}  // namespace hdr::internal
