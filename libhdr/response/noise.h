#pragma once
// The camera noise model: a pixel that holds e electrons has variance e + read_noise^2 (shot noise is Poisson, here its
// Gaussian limit); writing it as a code adds the rounding error of one code, 1/12, and compression some more.
#include <array>
#include <cmath>

namespace hdr {

struct NoiseModel {
  double full_well = 30000;  ///< electrons at which the largest code is reached
  double read_noise = 5;     ///< electrons, standard deviation
  double code_noise = 0;     ///< standard deviation in codes of what compression adds, besides the rounding

  /// Standard deviation, as a share of full well, of a linear level in [0,1], before it is written as a code.
  double stddev(double level) const {
    const double electrons = level * full_well;
    return std::sqrt((electrons > 0 ? electrons : 0) + read_noise * read_noise) / full_well;
  }
};

/// One for each channel: white balance gives them different gains, and so different full wells.
using Noise = std::array<NoiseModel, 3>;

}  // namespace hdr
