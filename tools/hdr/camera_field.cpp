#include "tools/hdr/camera_field.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/io/map_scale.h"
#include "libhdr/io/read.h"

namespace hdr::tools {
namespace {

/// A crop around a ball keeps the tag of what it was cut from, and would put the camera beside the ball.
bool is_whole_frame(Size size) {
  constexpr double kSlack = 0.01;
  const double shape = static_cast<double>(std::max(size.width, size.height)) / std::min(size.width, size.height);
  for (const double whole : {4.0 / 3, 3.0 / 2, 16.0 / 9}) {
    if (std::abs(shape / whole - 1) < kSlack) return true;
  }
  return false;
}

}  // namespace

std::optional<double> camera_field(const std::string& file, Size size) {
  try {
    if (!is_photo_name(file)) return read_camera_fov(file, size);
    const PhotoHeader header = read_photo_header(file);
    if (header.size == size && (header.fov_by_sensor || is_whole_frame(size))) return header.fov_degrees;
  } catch (const Error&) {  // a radiance map in a TIFF has no camera
  }
  return std::nullopt;
}

}  // namespace hdr::tools
