#include "capture/virtual/virtual_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/random.h"

namespace hdr {

double metered_sensitivity(View<const float> scene, const Exposure& exposure, double level) {
  std::vector<float> samples;
  samples.reserve(static_cast<std::size_t>(scene.width()) * static_cast<std::size_t>(scene.height()) * 3);
  for (int y = 0; y < scene.height(); ++y) {
    const float* row = scene.row(y);
    samples.insert(samples.end(), row, row + static_cast<std::ptrdiff_t>(scene.width()) * scene.channels());
  }
  if (samples.empty()) throw Error("virtual camera: the scene has no pixels");
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  double median = *middle;
  if (!(median > 0)) {  // more than half of the scene is black: meter on its brightest sample
    median = *std::max_element(samples.begin(), samples.end());
    if (!(median > 0)) median = 1;  // all black: any sensitivity photographs it
  }
  return level / (median * exposure.relative().value());
}

VirtualCamera::VirtualCamera(std::string uri, Image<float> scene, VirtualCameraOptions options)
    : uri_(std::move(uri)), scene_(std::move(scene)), options_(std::move(options)) {
  HDR_ASSERT(options_.latency >= 0);
}

Capabilities VirtualCamera::capabilities() const {
  return {uri_,
          "virtual camera",
          {fmt::format("RGB {} bit {}x{}", options_.sensor.response.bits, scene_.width(), scene_.height())},
          options_.min_seconds,
          options_.max_seconds};
}

void VirtualCamera::start() {
  if (running_) throw CameraError(CameraError::Kind::kWrongState, uri_ + ": already started");
  running_ = true;
  requested_ = std::clamp(1.0 / 60, options_.min_seconds, options_.max_seconds);
  pending_.assign(static_cast<std::size_t>(options_.latency), requested_);
}

void VirtualCamera::set(double seconds) {
  if (!running_) throw CameraError(CameraError::Kind::kWrongState, uri_ + ": not started; call start() first");
  if (!(seconds > 0) || !std::isfinite(seconds)) {
    throw CameraError(CameraError::Kind::kNotSupported,
                      fmt::format("{}: cannot expose for {} s; ask for a positive time", uri_, seconds));
  }
  requested_ = seconds;
}

Frame VirtualCamera::next_frame(std::chrono::steady_clock::time_point deadline) {
  if (!running_) throw CameraError(CameraError::Kind::kWrongState, uri_ + ": not started; call start() first");
  if (std::chrono::steady_clock::now() > deadline) {
    throw CameraError(CameraError::Kind::kTimeout, uri_ + ": no frame before the deadline");
  }
  pending_.push_back(std::clamp(requested_, options_.min_seconds, options_.max_seconds));
  const double seconds = pending_.front();
  pending_.pop_front();

  Exposure exposure = options_.optics;
  exposure.seconds = seconds;
  Frame frame;
  const std::uint64_t seed = hash64(options_.seed) + sequence_;
  if (scene_from_photo_.isIdentity(0)) {
    frame.photo = expose(scene_, exposure, options_.sensor, seed);
  } else {
    frame.photo = expose(shake(scene_, scene_from_photo_), exposure, options_.sensor, seed);
  }
  frame.photo.lossy = options_.lossy;
  frame.requested_seconds = requested_;
  frame.reported_seconds = seconds;
  frame.verified = Verified::kMetadata;
  frame.sequence = sequence_++;
  frame.timestamp = std::chrono::steady_clock::now().time_since_epoch();
  return frame;
}

void VirtualCamera::stop() {
  running_ = false;
}

}  // namespace hdr
