#pragma once
// A virtual camera whose truth is written down, for those who must find it out.
#include <string>
#include <vector>

#include "capture/virtual/virtual_camera.h"

namespace hdr::test {

class Witness : public VirtualCamera {
 public:
  using VirtualCamera::VirtualCamera;
  Frame next_frame(std::chrono::steady_clock::time_point deadline) override {
    Frame frame = VirtualCamera::next_frame(deadline);
    truth_.resize(std::max<std::size_t>(truth_.size(), frame.sequence + 1));
    truth_[frame.sequence] = true_exposure();
    return frame;
  }
  const ExposureSetting& truth(const Frame& frame) const { return truth_[frame.sequence]; }

 private:
  std::vector<ExposureSetting> truth_;
};

inline std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += "\n  " + line;
  return text;
}

}  // namespace hdr::test
