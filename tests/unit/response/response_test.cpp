#include "libhdr/response/response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"

namespace hdr {
namespace {

const char* const kNames[] = {"linear", "srgb", "gamma:2.2", "film"};

TEST(Response, EveryNamedCurveIsFiniteRisesAndIsZeroAtTheMiddleCode) {
  for (const char* name : kNames) {
    for (const int bits : {8, 12, 16}) {
      const Response response = *response_from_name(name, bits);
      EXPECT_EQ(response.levels(), bits == 8 ? 256 : 4096);
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(response.ln_exposure(c, std::ldexp(1.0, bits - 1)), 0) << name << " " << bits;
        const std::vector<float> table = response.exposure_table(c);
        ASSERT_EQ(table.size(), std::size_t{1} << bits);
        EXPECT_GT(table[0], 0) << "code 0 stands for the middle of its cell, not for ln 0";
        for (std::size_t code = 1; code < table.size(); ++code) {
          ASSERT_GE(table[code], table[code - 1]) << name << " " << bits << " bits, code " << code;
        }
      }
    }
  }
}

TEST(Response, IsTheLogOfTheInverseOfTheFormula) {
  const Response srgb = srgb_response(8), gamma = gamma_response(16, 2.2), linear = linear_response(16);
  const double middle = linear_from_srgb(128 / 255.0);
  for (const int code : {1, 10, 100, 255}) {
    EXPECT_NEAR(srgb.ln_exposure(0, code), std::log(linear_from_srgb(code / 255.0) / middle), 1e-12) << code;
  }
  for (const double code : {1.0, 7.0, 1000.5, 40000.0, 65535.0}) {
    EXPECT_NEAR(linear.exposure(1, code), code / 32768, 1e-9) << "a linear curve stays linear between its samples";
  }
  EXPECT_NEAR(gamma.ln_exposure(2, 65520), 2.2 * std::log(65520 / 32768.0), 1e-12);
}

TEST(Response, TheFilmsChannelsDifferAndItsLastCodeIsWide) {
  const Response film = film_response(8);
  EXPECT_GT(std::abs(film.g[0][40] - film.g[2][40]), 0.02);
  const double last_step = film.g[1][255] - film.g[1][254], middle_step = film.g[1][129] - film.g[1][128];
  EXPECT_GT(last_step, 1.5 * middle_step) << "the shoulder packs more light into a code";
  const double toe = film.g[1][2] - film.g[1][1], straight = std::log(2.0);
  EXPECT_LT(toe, straight) << "near black the film has more contrast than a linear sensor";
}

TEST(Response, NamesAreParsedAndFileNamesAreNot) {
  EXPECT_FALSE(response_from_name("camera.json", 8));
  EXPECT_FALSE(response_from_name("", 8));
  EXPECT_THROW(response_from_name("gamma:0", 8), Error);
  EXPECT_THROW(response_from_name("gamma:2.2x", 8), Error);
  EXPECT_THROW(response_from_name("gamma:nan", 8), Error);
}

TEST(Response, JsonRoundTripIsExact) {
  for (const int bits : {8, 12, 16}) {
    const Response response = film_response(bits);
    const Response again = response_from_json(json_from_response(response, 0.01), "film.json");
    EXPECT_EQ(again.bits, bits);
    EXPECT_EQ(again.g, response.g);
  }
}

TEST(Response, JsonHasTheKeysOfTheContract) {
  const auto json = nlohmann::json::parse(json_from_response(srgb_response(8), 0.25));
  EXPECT_EQ(json["format"], "hdr-response");
  EXPECT_EQ(json["version"], 1);
  EXPECT_EQ(json["levels"], 256);
  EXPECT_EQ(json["rms_log_error"], 0.25);
  for (const char* channel : {"R", "G", "B"}) {
    EXPECT_EQ(json["g"][channel].size(), 256u);
    EXPECT_EQ(json["g"][channel][128], 0);
  }
}

TEST(Response, ABadFileIsAnErrorThatNamesItAndThePlace) {
  const auto good = nlohmann::json::parse(json_from_response(srgb_response(8)));
  const auto message = [](const std::string& text) -> std::string {
    try {
      response_from_json(text, "cam.json");
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  const auto with = [&](auto change) {
    nlohmann::json json = good;
    change(json);
    return message(json.dump());
  };
  using Json = nlohmann::json;
  EXPECT_EQ(message("{nonsense").rfind("cam.json: not JSON", 0), 0u);
  EXPECT_NE(message("[]").find("cam.json"), std::string::npos);
  EXPECT_NE(with([](Json& j) { j.erase("format"); }).find("format"), std::string::npos);
  EXPECT_NE(with([](Json& j) { j["version"] = 2; }).find("version"), std::string::npos);
  EXPECT_NE(with([](Json& j) { j["levels"] = "256"; }).find("levels"), std::string::npos);
  EXPECT_NE(with([](Json& j) { j["g"]["G"].erase(0); }).find("g.G: has 255 values"), std::string::npos);
  EXPECT_NE(with([](Json& j) { j["g"].erase("B"); }).find("no g.B"), std::string::npos);
  EXPECT_NE(with([](Json& j) { j["g"]["R"][7] = nullptr; }).find("g.R[7]"), std::string::npos);
  EXPECT_NE(with([](Json& j) { j["g"]["R"][7] = "x"; }).find("g.R[7]"), std::string::npos);
  EXPECT_NE(with([](Json& j) { j["g"]["R"][200] = -3; }).find("decreases"), std::string::npos);
  EXPECT_NE(with([](Json& j) { j["g"]["R"] = std::vector<double>(256, 0.0); }).find("flat"), std::string::npos);
  EXPECT_NE(with([](Json& j) { j["bits"] = 12; }).find("bits"), std::string::npos);
}

TEST(Response, AFlatStartIsABlackLevel) {
  Response response = srgb_response(8);
  EXPECT_EQ(response.black_code(0), 0);
  for (std::size_t code = 0; code <= 16; ++code) response.g[1][code] = response.g[1][16];
  EXPECT_EQ(response.black_code(1), 16);
  EXPECT_EQ(response.black_code(2), 0);
}

}  // namespace
}  // namespace hdr
