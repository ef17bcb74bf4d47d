#pragma once
// Brackets from which no method can learn a response, and what each must say of them.
#include <functional>
#include <string>

#include "libhdr/core/error.h"
#include "libhdr/response/calibrate.h"
#include "tests/unit/response/simulated.h"

namespace hdr::test {

using Calibrate = std::function<Calibration(const Bracket&)>;

inline void expect_errors_for_hopeless_brackets(const Calibrate& calibrate) {
  const auto message = [&](const Bracket& bracket) -> std::string {
    try {
      calibrate(bracket);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  const auto expect = [&](const char* what, const Bracket& bracket, const char* part) {
    const std::string text = message(bracket);
    EXPECT_NE(text.find(part), std::string::npos) << what << ": " << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << what << ": one line";
  };
  const auto taken_at = [](std::vector<double> evs, int side = 0) {
    Simulation simulation;
    simulation.evs = std::move(evs);
    if (side > 0) simulation.width = simulation.height = side;
    return simulate(srgb_response(8), simulation);
  };
  expect("nothing", Bracket{}, "no shots");
  expect("one shot", taken_at({0}), "shot0.png: one shot");
  expect("equal exposures", taken_at({0, 0, 0}), "exposures are equal");
  expect("all black", taken_at({-30, -28, -26}), "too few pixels");
  expect("all white", taken_at({26, 28, 30}), "too few pixels");
  expect("2x2", taken_at({-2, 0, 2}, 2), "too few pixels");
  Bracket reversed = simulate(srgb_response(8), {});
  for (std::size_t j = 0; j < reversed.shots.size(); ++j) {
    reversed.shots[j].exposure.seconds = std::exp2(-2.0 * static_cast<double>(j));
  }
  expect("times reversed", reversed, "not brighter");
  for (const double seconds : {0.0, -1.0, static_cast<double>(NAN)}) {
    Bracket bracket = taken_at({-2, 0, 2});
    bracket.shots[1].exposure.seconds = seconds;
    expect("a time that is none", bracket, "shot1.png: its exposure is not a positive number");
  }
}

/// What every Response promises.
inline void expect_a_response(const Response& response, int bits) {
  EXPECT_EQ(response.bits, bits);
  for (const auto& curve : response.g) {
    ASSERT_EQ(static_cast<int>(curve.size()), response_levels(bits));
    EXPECT_EQ(curve[curve.size() / 2], 0) << "g(2^(bits-1)) = 0";
    EXPECT_TRUE(std::is_sorted(curve.begin(), curve.end()));
    EXPECT_TRUE(std::isfinite(curve.front()) && std::isfinite(curve.back()));
  }
}

inline void blacken_channel(Bracket& bracket, int channel) {
  for (Photo& photo : bracket.shots) {
    auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
    for (int y = 0; y < codes.height(); ++y) {
      for (int x = 0; x < codes.width(); ++x) codes(x, y, channel) = 0;
    }
  }
}

}  // namespace hdr::test
