#pragma once
// The simulated USB camera, for tests inside the virtual machine.
#include <cstdint>
#include <string>
#include <vector>

#include "libhdr/core/image.h"

namespace hdr::test {

/// uvc_sim with these options, plugged in while it lives.
class Simulator {
 public:
  explicit Simulator(std::vector<std::string> options = {});
  /// Waits until the kernel has forgotten the device.
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  const std::string& node() const { return node_; }  ///< "/dev/video0"
  /// Modes of exposure, frame rate and white balance, its temperature, and gain.
  std::vector<std::int64_t> settings() const;
  void unplug() const;

  /// What the sensor really used, for frame `sequence` of the stream-th STREAMON.
  struct Used {
    int stream, sequence, exposure_100us, gain_16ths;
  };
  std::vector<Used> used() const;

 private:
  int process_ = -1;
  int to_child_ = -1;
  std::string node_, log_;
};

/// The radiance of the simulated scene: what a merge should find, up to one factor.
Image<float> simulated_scene(Size size);

/// Median over all samples of |value / truth - 1|, after the factor that makes the median ratio 1.
double median_error(View<const float> map, View<const float> truth);

}  // namespace hdr::test
