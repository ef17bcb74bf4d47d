#pragma once
// Gauss-Legendre quadrature.
#include <vector>

namespace hdr {

struct GaussRule {
  std::vector<double> nodes;    ///< in (0, 1), rising
  std::vector<double> weights;  ///< sum to 1
};

/// The rule of n nodes on [0, 1]: exact for polynomials up to degree 2n - 1.
GaussRule gauss_legendre(int n);

/// Nodes that integrate a wave of at most `frequency` radians per unit over `width` units to the last digits of a
/// double: the error falls faster than exponentially once there is a node for each radian of half the phase.
int gauss_nodes_for_wave(double frequency, double width);

}  // namespace hdr
