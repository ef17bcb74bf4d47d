#pragma once
// The camera noise model: a pixel that holds e electrons has variance e + read_noise^2 (shot noise is Poisson, here its
// Gaussian limit), and writing it as a code adds the rounding error of one code, 1/12.
#include <cmath>

namespace hdr {

struct NoiseModel {
  double full_well = 30000;  ///< electrons at which the largest code is reached
  double read_noise = 5;     ///< electrons, standard deviation

  /// Standard deviation, as a share of full well, of a linear level in [0,1].
  double stddev(double level) const {
    const double electrons = level * full_well;
    return std::sqrt((electrons > 0 ? electrons : 0) + read_noise * read_noise) / full_well;
  }
};

}  // namespace hdr
