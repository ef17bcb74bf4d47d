#pragma once
// Sums of a picture's passes, and what they tell of its error.
#include <cstdint>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// One pass's estimate of a pixel: a mean over its camera rays.
struct PixelEstimate {
  Rgb radiance = Rgb::Zero();
  Vec3f normal = Vec3f::Zero();
  float coverage = 0;
  Rgb ground = Rgb::Zero();  ///< what of the radiance comes from shadow catchers
  float ground_share = 0;    ///< of the camera rays
  double doubt = 0;          ///< luminance that all passes may be off by alike
};

class Film {
 public:
  explicit Film(Size size);

  /// `weight` is the work behind the estimate: its variance is taken to fall as 1 / weight.
  void add(std::size_t pixel, const PixelEstimate& estimate, double weight);

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) + static_cast<std::size_t>(x);
  }
  Size size() const { return size_; }
  std::size_t count() const { return pixels_.size(); }
  Rgb radiance(std::size_t pixel) const;
  float coverage(std::size_t pixel) const;
  Rgb ground(std::size_t pixel) const;
  float ground_share(std::size_t pixel) const;
  Vec3f normal(std::size_t pixel) const;  ///< mean of the camera rays' normals; 0 where nothing was met
  double weight(std::size_t pixel) const { return pixels_[pixel].weight; }
  double luminance_of(std::size_t pixel) const;
  /// Of the luminance of the mean over the passes, from their spread; -1, not known, after fewer than two.
  double variance(std::size_t pixel) const;
  /// Luminance that the passes may be off by together, as the last of them says, which knows most.
  double doubt(std::size_t pixel) const { return pixels_[pixel].doubt; }
  /// Mean square of how far off the pixel's luminance may be, by chance and by doubt; -1 where that is not known.
  double square_error(std::size_t pixel) const;

 private:
  struct Pixel {
    Rgb radiance = Rgb::Zero();  ///< here and below: sums, weighted
    Vec3f normal = Vec3f::Zero();
    double squares = 0;  ///< of luminance
    Rgb ground = Rgb::Zero();
    double weight = 0, coverage = 0, ground_share = 0, doubt = 0;
    int passes = 0;
  };
  Size size_;
  std::vector<Pixel> pixels_;
};

}  // namespace hdr
