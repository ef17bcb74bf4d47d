#include "libhdr/light/internal/quadrature.h"

#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

struct LegendreValue {
  double p, derivative;
};

// P_n and P_n' by Bonnet's recurrence (k + 1) P_k+1 = (2k + 1) x P_k - k P_k-1.
LegendreValue legendre(int n, double x) {
  double previous = 1, p = x;
  for (int k = 1; k < n; ++k) {
    const double next = ((2 * k + 1) * x * p - k * previous) / (k + 1);
    previous = p;
    p = next;
  }
  return {p, n * (x * p - previous) / (x * x - 1)};
}

}  // namespace

GaussRule gauss_legendre(int n) {
  HDR_ASSERT(n >= 1);
  GaussRule rule{std::vector<double>(static_cast<std::size_t>(n)), std::vector<double>(static_cast<std::size_t>(n))};
  for (int i = 0; i < n; ++i) {
    // Newton's iteration from Tricomi's estimate of the root, which lies in its basin for every n.
    double x = -std::cos(kPi * (i + 0.75) / (n + 0.5));
    for (int step = 0; step < 8; ++step) {
      const LegendreValue value = legendre(n, x);
      x -= value.p / value.derivative;
    }
    const double derivative = legendre(n, x).derivative;
    const auto k = static_cast<std::size_t>(i);
    rule.nodes[k] = 0.5 * (1 + x);
    rule.weights[k] = 1 / ((1 - x * x) * derivative * derivative);
  }
  return rule;
}

int gauss_nodes_for_wave(double frequency, double width) {
  return 8 + static_cast<int>(std::ceil(0.5 * frequency * width));
}

}  // namespace hdr
