#pragma once
// Drawing one of n things with given weights by inverting their running sums.
#include <cstdint>
#include <span>
#include <vector>

namespace hdr {

/// Non-negative weights, sums in double. A guide table tells where to look [Chen74]: most draws find their step at the
/// first look, however many steps there are. A larger u never gives an earlier step.
class StepDistribution {
 public:
  StepDistribution() = default;
  explicit StepDistribution(std::span<const double> weights);

  struct Step {
    int index;
    double inside;  ///< where u lies in the step, 0..1
  };

  /// The step that u in [0,1) falls into; never one of no weight (unless all are).
  Step step_of(double u) const;
  /// The u with step_of(u) = step; for a step of no weight, where it would begin.
  double invert(const Step& step) const;
  double total() const { return total_; }

 private:
  std::vector<double> sums_;          ///< size + 1, from exactly 0 to exactly 1; all 0 when no step has weight
  std::vector<std::uint32_t> guide_;  ///< the step that k / size falls into; size is a power of two: u * size is exact
  double total_ = 0;
};

}  // namespace hdr
