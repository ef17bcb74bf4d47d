#include "libhdr/probe/unwrap.h"

#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "libhdr/probe/internal/footprint.h"
#include "libhdr/probe/internal/source_picture.h"

namespace hdr {
namespace {

void require_picture(Size size, const char* which) {
  if (size.width > 0 && size.height > 0) return;
  throw Error(fmt::format("resample: the {} picture of {}x{} pixels is empty", which, size.width, size.height));
}

/// Rotations of a rotation's own size, so that unit directions stay unit.
void require_rotation(const Mat3& rotation) {
  constexpr double kTolerance = 1e-6;
  if ((rotation * rotation.transpose()).isIdentity(kTolerance) && rotation.determinant() > 0) return;
  throw Error("resample: the matrix between the axes is not a rotation");
}

}  // namespace

Image<float> resample(View<const float> source, const Projection& from, const Projection& to, Size size,
                      const Mat3& source_from_probe, int max_samples) {
  require_picture(source.size(), "source");
  require_picture(size, "output");
  require_valid(from);
  require_valid(to);
  require_rotation(source_from_probe);
  return internal::average_footprints(internal::SourcePicture(source, from),
                                      internal::source_from_run(from, to, source_from_probe), size, max_samples)
      .mean;
}

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
