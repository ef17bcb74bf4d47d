// Curves known beforehand, each the inverse of its formula: level in [0,1] of full well <- code / largest code.
#include <charconv>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/response/response.h"

namespace hdr {
namespace {

/// Samples ln of `level_from_value(channel, value)`, value = code / (2^bits - 1), and moves g(2^(bits-1)) to 0.
template <class Inverse>
Response sampled(int bits, const Inverse& level_from_value) {
  HDR_ASSERT(bits >= 2 && bits <= 16);
  Response response;
  response.bits = bits;
  const double max_code = std::ldexp(1.0, bits) - 1;
  const int levels = response_levels(bits);
  for (int c = 0; c < 3; ++c) {
    auto& curve = response.g[static_cast<std::size_t>(c)];
    const double middle = std::log(level_from_value(c, std::ldexp(1.0, bits - 1) / max_code));
    // Code 0: half the level at which rounding first gives code 1.
    curve.push_back(std::log(0.5 * level_from_value(c, 0.5 / max_code)) - middle);
    for (int k = 1; k < levels; ++k) {
      curve.push_back(std::log(level_from_value(c, response.code_from_level(k) / max_code)) - middle);
    }
  }
  return response;
}

/// A Naka-Rushton (Hill) curve: value = (1 + s) x^p / (x^p + s). Against ln x it is a sigmoid as the density of film
/// is, with the toe where x^p << s and a shoulder that is still rising, slowly, at full well.
struct Hill {
  double power, half;
  double level(double value) const { return std::pow(half * value / (1 + half - value), 1 / power); }
};

}  // namespace

Response linear_response(int bits) {
  return sampled(bits, [](int, double value) { return value; });
}

Response srgb_response(int bits) {
  return sampled(bits, [](int, double value) { return linear_from_srgb(value); });
}

Response gamma_response(int bits, double gamma) {
  return sampled(bits, [gamma](int, double value) { return std::pow(value, gamma); });
}

Response film_response(int bits) {
  static constexpr Hill kChannels[3] = {{1.10, 0.16}, {1.05, 0.18}, {1.00, 0.20}};
  return sampled(bits, [](int channel, double value) { return kChannels[channel].level(value); });
}

std::optional<Response> response_from_name(const std::string& name, int bits) {
  if (name == "linear") return linear_response(bits);
  if (name == "srgb") return srgb_response(bits);
  if (name == "film") return film_response(bits);
  static const std::string kGamma = "gamma:";
  if (name.rfind(kGamma, 0) != 0) return std::nullopt;
  double gamma = 0;
  const char* end = name.data() + name.size();
  const auto [stop, problem] = std::from_chars(name.data() + kGamma.size(), end, gamma);
  if (problem != std::errc() || stop != end || !(gamma >= 0.1 && gamma <= 10)) {
    throw Error(name + ": not a gamma between 0.1 and 10; write for example gamma:2.2");
  }
  return gamma_response(bits, gamma);
}

}  // namespace hdr
