#include "tests/bench/film.h"

#include <cmath>
#include <functional>

#include "libhdr/core/random.h"

namespace hdr::bench {
namespace {

using Curve = std::function<double(double)>;  ///< level 0..1 of full well -> value 0..1, rising

Curve random_curve(std::uint64_t seed, int channel) {
  Random film(seed, 1);
  const double kind = film.uniform(), first = film.uniform(), second = film.uniform();
  Random own(seed, 2, static_cast<std::uint64_t>(channel));
  const double a = first + 0.1 * (own.uniform() - 0.5), b = second + 0.1 * (own.uniform() - 0.5);
  if (kind < 1.0 / 3) {
    const double power = 0.8 + 0.4 * a, half = 0.12 + 0.2 * b;
    return [=](double x) { return (1 + half) * std::pow(x, power) / (std::pow(x, power) + half); };
  }
  if (kind < 2.0 / 3) {
    const double rate = 1.5 + 2.5 * a, gamma = 1.2 + 0.7 * b;
    return [=](double x) { return std::pow(-std::expm1(-rate * x) / -std::expm1(-rate), 1 / gamma); };
  }
  const double slope = 0.6 + 0.4 * a, middle = std::log(0.1 + 0.1 * b);
  const auto density = [=](double x) { return std::atan(slope * (std::log(x) - middle)) + 1.5707963267948966; };
  return [=](double x) { return x > 0 ? density(x) / density(1) : 0; };
}

/// The level that gives `value`, by bisection of ln level.
double level_of(const Curve& curve, double value) {
  double low = std::log(1e-9), high = 0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (curve(std::exp(middle)) < value ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

}  // namespace

Response random_film_response(std::uint64_t seed) {
  Response response;
  for (int c = 0; c < 3; ++c) {
    const Curve curve = random_curve(seed, c);
    const double middle = std::log(level_of(curve, 128.0 / 255));
    auto& g = response.g[static_cast<std::size_t>(c)];
    g.push_back(std::log(0.5 * level_of(curve, 0.5 / 255)) - middle);  // as Response has code 0
    for (int code = 1; code < 256; ++code) g.push_back(std::log(level_of(curve, code / 255.0)) - middle);
  }
  return response;
}

}  // namespace hdr::bench
