#pragma once
// Resampling from one projection to another.
#include <memory>

#include "libhdr/core/radiance.h"
#include "libhdr/probe/projection.h"

namespace hdr {

/// Picture `to` (of the given size) from picture `source` (projection `from`), where probe direction d shows what
/// `source` has in direction source_from_probe * d. Each output pixel is a mean of the source weighed by a kernel on
/// the parallelogram that the Jacobian makes of an output pixel, and no less than a source pixel [Heckbert89]: cubic
/// convolution [Keys81] where the picture is made smaller and has detail that smaller pixels cannot show, a windowed
/// sinc of eight points elsewhere, and linear interpolation around suns (brighter than eight times what surrounds
/// them), where those would ring. It wraps at a lat-long's seam and crosses its poles, a cube's edges and an
/// octahedron's. Pixels that a ball's or a lens's rim cuts do not count. A pixel of which the output or the source
/// shows a part is what that part shows in its middle; what the source does not show is 0. Where no source sample is
/// negative no result is. Channels as the source. The same bytes for any number of threads.
Image<float> resample(View<const float> source, const Projection& from, const Projection& to, Size size,
                      const Mat3& source_from_probe = Mat3::Identity());

/// resample() by bands of rows, for who does not keep the whole output: the same bytes. The source must outlive it, and
/// so must its standard deviations, where they are given (as large as the source, one channel or as many).
class Resampler {
 public:
  static constexpr int kGrain = 32;  ///< bands begin at multiples of this many rows

  Resampler(View<const float> source, const Projection& from, const Projection& to, Size size,
            const Mat3& source_from_probe = Mat3::Identity(), View<const float> stddev = {});
  ~Resampler();

  /// Rows of the output; what is empty is not wanted.
  struct Band {
    View<float> values;
    View<float> shown{};   ///< one channel: 1 where the source shows something, else 0
    View<float> stddev{};  ///< of the values: errors of the source's pixels are independent of each other
  };
  /// Rows first, first + 1, ... of the output, as many as `band.values` has.
  void rows(int first, const Band& band) const;
  void rows(int first, View<float> values) const { rows(first, Band{values}); }

 private:
  struct Job;
  std::unique_ptr<const Job> job_;
};

/// resample() with the map's tags kept and its projection set to `to`. Standard deviations are propagated through the
/// kernels. Where the source does not show all of what the output has room for, `alpha` is 0 there and 1 elsewhere
/// (times the source's own); where it does, the result has alpha when the source has.
RadianceMap unwrap(const RadianceMap& source, const Projection& from, const Projection& to, Size size,
                   const Mat3& source_from_probe = Mat3::Identity());

}  // namespace hdr
