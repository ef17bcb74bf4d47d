#include "libhdr/response/internal/curve_prior.h"

#include <cmath>

#include "libhdr/response/internal/emor.h"

namespace hdr {

std::array<Eigen::VectorXd, 3> emor_prior(const Knots& knots, const Observations& seen) {
  constexpr double kResolved = 0.1;  // deviation, ln, up to which the family is believed
  Eigen::VectorXd codes(knots.count() - 1);
  for (int k = 1; k < knots.count(); ++k) codes[k - 1] = knots.code(k);
  const EmorFit fit = fit_emor(seen, codes);
  std::array<Eigen::VectorXd, 3> priors;
  for (std::size_t c = 0; c < 3; ++c) {
    const EmorChannel& channel = fit.channels[c];
    if (channel.g.size() == 0) continue;
    int first = knots.middle();  // the lowest knot of those that are resolved
    while (first > 1 && channel.stddev[first - 2] < kResolved) --first;
    Eigen::VectorXd& prior = priors[c];
    prior.resize(knots.count());
    prior.tail(knots.count() - 1) = channel.g;
    // The slope over the first resolved tenth of the way up: two neighbouring codes of the basis are too close.
    const int above = std::min(knots.middle(), first + std::max(1, (knots.middle() - first) / 10));
    const double slope = (prior[above] - prior[first]) / (knots.u(above) - knots.u(first));
    for (int k = 0; k < first; ++k) prior[k] = prior[first] + slope * (knots.u(k) - knots.u(first));
  }
  return priors;
}

double ambiguous_step(const Eigen::VectorXd& ln_exposure) {
  constexpr double kLargeStep = 1.5, kTolerance = 0.08;  // stops
  double step = INFINITY;
  for (Eigen::Index j = 1; j < ln_exposure.size(); ++j) {
    const double apart = (ln_exposure[j] - ln_exposure[j - 1]) / std::log(2.0);
    if (apart > kTolerance) step = std::min(step, apart);
  }
  if (!(step >= kLargeStep && std::isfinite(step))) return 0;
  for (Eigen::Index j = 1; j < ln_exposure.size(); ++j) {
    const double steps = (ln_exposure[j] - ln_exposure[0]) / (std::log(2.0) * step);
    if (std::abs(steps - std::round(steps)) * step > kTolerance) return 0;
  }
  return step;
}

}  // namespace hdr
