#pragma once
// OpenCV's resampling of pictures, to be measured against.
#include <functional>
#include <memory>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr::bench {

enum class RemapKernel { kNearest, kLinear, kCubic, kLanczos4 };

/// cv::remap with maps that are made beforehand, in OpenCV's own fixed-point form.
class OpenCvRemap {
 public:
  /// Where output pixels lie in the source, continuous pixels; NaN: nowhere.
  OpenCvRemap(Size output, const std::function<Vec2(int x, int y)>& source_from_output);
  ~OpenCvRemap();

  /// This is what is timed.
  void run(View<const float> source, View<float> output, int threads,
           RemapKernel kernel = RemapKernel::kLanczos4) const;

 private:
  struct Maps;
  std::unique_ptr<Maps> maps_;
};

}  // namespace hdr::bench
