#include "tests/stress/hostile.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <ostream>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/response/expose.h"
#include "tests/support/scene.h"

namespace hdr::stress {
namespace {

// The same cases in every run; RC_PARAMS of the environment has the last word ("seed=7 max_success=10000" to look
// further).
[[maybe_unused]] const int kSeeded = setenv("RC_PARAMS", "seed=20030623 max_success=60", 0);

constexpr const char* kLights[] = {"constant",     "spread",   "one hot", "denormal",
                                   "checkerboard", "pedestal", "black",   "sun"};

float sample_of(Light light, int x, int y, int c, Random& random, double level) {
  switch (light) {
    case Light::kConstant:
      return static_cast<float>(level);
    case Light::kSpread:
      return static_cast<float>(std::pow(10, 24 * random.uniform() - 12));
    case Light::kDenormal:
      return random.bits() % 3 == 0 ? 0.0f : static_cast<float>(random.bits() % 1000) * 0x1p-149f;
    case Light::kCheckerboard:
      return (x + y) % 2 == 0 ? 1e-12f : 1e12f;
    case Light::kPedestal:
      return 1e6f + 0.125f * static_cast<float>(static_cast<int>(random.bits() % 17) - 8 + c);
    case Light::kSun:
      return 0.1f + random.uniform_float();
    case Light::kOneHot:
    case Light::kBlack:
      break;
  }
  return 0;
}

rc::Gen<int> side(int largest) {
  return rc::gen::oneOf(rc::gen::inRange(1, largest + 1), rc::gen::element(1, 2, 3, largest),
                        rc::gen::element(7, 13, 16, largest - 1));
}

rc::Gen<Light> any_light() {
  return rc::gen::map(rc::gen::inRange(0, 8), [](int k) { return static_cast<Light>(k); });
}

}  // namespace

rc::Gen<double> power_of_ten(double low, double high) {
  return rc::gen::map(rc::gen::oneOf(rc::gen::inRange(0, 1001),
                                     rc::gen::element(0, 1000, static_cast<int>(-1000 * low / (high - low)))),
                      [=](int k) { return std::pow(10, low + (high - low) * k / 1000); });
}

rc::Gen<Vec3> direction() {
  return rc::gen::exec([] {
    const std::uint64_t seed = *rc::gen::inRange<std::uint64_t>(0, 1u << 30);
    const int kind = *rc::gen::inRange(0, 9);
    Random random(seed, 1);
    const Vec3 any = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    if (kind == 0) return any;
    static const Vec3 kSpecial[] = {Vec3::UnitY(),  -Vec3::UnitY(), Vec3::UnitZ(),
                                    -Vec3::UnitZ(), Vec3::UnitX(),  -Vec3::UnitX()};
    const Vec3 special = kSpecial[seed % 6];
    if (kind == 1) return special;
    if (kind == 2)
      return Vec3(-0.0, special.y(), special.z() == 0 ? 1 - std::abs(special.y()) : special.z()).normalized();
    return Vec3((special + std::pow(10, -2.0 * kind) * any).normalized());
  });
}

std::ostream& operator<<(std::ostream& out, const MapPlan& plan) {
  return out << fmt::format("{}x{} {}, seed {}", plan.width, plan.height, kLights[static_cast<int>(plan.light)],
                            plan.seed);
}

Image<float> made(const MapPlan& plan) {
  Image<float> map(plan.width, plan.height, 3);
  Random random(plan.seed, 17);
  const double level = std::pow(10, 24 * random.uniform() - 12);
  for (int y = 0; y < plan.height; ++y) {
    for (int x = 0; x < plan.width; ++x) {
      for (int c = 0; c < 3; ++c) map(x, y, c) = sample_of(plan.light, x, y, c, random, level);
    }
  }
  const int x = static_cast<int>(random.bits() % static_cast<unsigned>(plan.width));
  const int y = static_cast<int>(random.bits() % static_cast<unsigned>(plan.height));
  if (plan.light == Light::kOneHot) map(x, y, static_cast<int>(random.bits() % 3)) = 1e12f;
  if (plan.light == Light::kSun) {
    for (int c = 0; c < 3; ++c) map(x, y, c) = 1e9f;
  }
  return map;
}

rc::Gen<MapPlan> any_map(int largest) {
  return rc::gen::exec([=] {
    return MapPlan{*side(largest), *side(largest), *any_light(), *rc::gen::inRange<std::uint64_t>(0, 1000000)};
  });
}

rc::Gen<MapPlan> any_latlong(int largest_width) {
  return rc::gen::exec([=] {
    const int height = *side(largest_width / 2);
    return MapPlan{2 * height, height, *any_light(), *rc::gen::inRange<std::uint64_t>(0, 1000000)};
  });
}

void spoil(Image<float>& map, std::uint64_t seed) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kFaults[] = {std::numeric_limits<float>::quiet_NaN(),
                               kInfinity,
                               -kInfinity,
                               -1,
                               -1e30f,
                               -0.0f,
                               std::numeric_limits<float>::max(),
                               std::numeric_limits<float>::denorm_min()};
  Random random(seed, 3);
  for (int y = 0; y < map.height(); ++y) {
    for (std::size_t k = 0; k < map.row_samples(); ++k) {
      if (random.bits() % 3 == 0) map.row(y)[k] = kFaults[random.bits() % std::size(kFaults)];
    }
  }
}

std::ostream& operator<<(std::ostream& out, const BracketCase& plan) {
  return out << fmt::format("{}x{}, {} shots of {} bits {} stops apart, {}, {}, seed {}", plan.width, plan.height,
                            plan.shots, plan.bits, plan.stops_apart, bracket_kinds[static_cast<std::size_t>(plan.kind)],
                            plan.lossy ? "lossy" : "lossless", plan.seed);
}

namespace {

template <class Code>
Image<Code> codes_of(const BracketCase& plan, int shot) {
  Image<Code> codes(plan.width, plan.height, 3);
  Random random(plan.seed, static_cast<std::uint64_t>(shot));
  const auto most = static_cast<std::uint32_t>((1 << plan.bits) - 1), one = random.bits() % (most + 1);
  for (int y = 0; y < plan.height; ++y) {
    for (std::size_t k = 0; k < codes.row_samples(); ++k) {
      std::uint32_t code = 0;
      if (plan.kind == 2) code = most;
      if (plan.kind == 3) code = one;
      if (plan.kind == 4) code = random.bits() % (most + 1);
      if (plan.kind == 5) code = random.bits() % 2 ? most / 2 : most / 2 + 1;
      if (plan.kind == 6) code = most / static_cast<std::uint32_t>(shot + 2);
      codes.row(y)[k] = static_cast<Code>(code);
    }
  }
  return codes;
}

}  // namespace

Bracket made(const BracketCase& plan) {
  Bracket bracket;
  const Sensor sensor{srgb_response(plan.bits), {}, 0.18};
  const Image<float> scene = test::test_scene(plan.width, plan.height, 12, plan.seed);
  for (int k = 0; k < plan.shots; ++k) {
    Exposure exposure;
    exposure.seconds = std::exp2(plan.stops_apart * (k - 0.5 * (plan.shots - 1)));
    Photo photo;
    if (plan.kind == 0) {
      photo = expose(scene, exposure, sensor, plan.seed + static_cast<std::uint64_t>(k));
    } else if (plan.bits <= 8) {
      photo.codes = codes_of<std::uint8_t>(plan, k);
    } else {
      photo.codes = codes_of<std::uint16_t>(plan, k);
    }
    photo.bits = plan.bits;
    photo.lossy = plan.lossy;
    photo.exposure = exposure;
    photo.path = fmt::format("shot{}.png", k);
    bracket.shots.push_back(std::move(photo));
    bracket.input_order.push_back(k);
  }
  return bracket;
}

rc::Gen<BracketCase> any_bracket(int largest) {
  return rc::gen::exec([=] {
    BracketCase plan;
    plan.width = *side(largest);
    plan.height = *side(largest);
    plan.shots = *rc::gen::inRange(1, 6);
    plan.bits = *rc::gen::element(8, 8, 12, 16);
    plan.stops_apart = *rc::gen::element(1.0, 2.0, 0.01, 1e-6, 7.0, 40.0 / std::max(1, plan.shots - 1));
    plan.kind = *rc::gen::oneOf(rc::gen::just(0), rc::gen::inRange(0, static_cast<int>(bracket_kinds.size())));
    plan.lossy = *rc::gen::element(false, true);
    plan.seed = *rc::gen::inRange<std::uint64_t>(1, 100000);
    return plan;
  });
}

std::string fault_of(View<const float> map) {
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      for (int c = 0; c < map.channels(); ++c) {
        const float v = map(x, y, c);
        if (!std::isfinite(v) || v < 0) return fmt::format("{} at ({}, {}), channel {}", v, x, y, c);
      }
    }
  }
  return {};
}

double smallest_of(View<const float> map) {
  double least = std::numeric_limits<double>::infinity();
  for (int y = 0; y < map.height(); ++y) {
    for (int k = 0; k < map.width() * map.channels(); ++k) least = std::min<double>(least, map.row(y)[k]);
  }
  return least;
}

double largest_of(View<const float> map) {
  double most = -std::numeric_limits<double>::infinity();
  for (int y = 0; y < map.height(); ++y) {
    for (int k = 0; k < map.width() * map.channels(); ++k) most = std::max<double>(most, map.row(y)[k]);
  }
  return most;
}

}  // namespace hdr::stress
