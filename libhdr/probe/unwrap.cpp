#include "libhdr/probe/unwrap.h"

namespace hdr {

RadianceMap unwrap(const RadianceMap& source, const Projection& from, const Projection& to, Size size,
                   const Mat3& source_from_probe) {
  const auto resampled = [&](const Image<float>& plane) {
    return plane.empty() ? Image<float>() : resample(plane, from, to, size, source_from_probe);
  };
  RadianceMap result;
  result.rgb = resampled(source.rgb);
  result.alpha = resampled(source.alpha);
  result.stddev = resampled(source.stddev);
  result.chromaticities = source.chromaticities;
  result.white_luminance = source.white_luminance;
  result.projection = text_from_projection(to);
  return result;
}

}  // namespace hdr
