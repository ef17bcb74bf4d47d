#include "capture/shoot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "capture/verify.h"

namespace hdr {
namespace {

class Running {
 public:
  Running(CameraDevice& camera, const ExposureSetting& first) : camera_(camera) { camera_.start(first); }
  ~Running() { camera_.stop(); }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

 private:
  CameraDevice& camera_;
};

bool same(double total, double other) {
  return std::abs(std::log(total / other)) < 0.01;
}

const VerifiedFrame* taken_already(const Verifier& verifier, const ExposureSetting& setting) {
  for (const VerifiedFrame& known : verifier.verified()) {
    const ExposureSetting& exposure = *known.frame.exposure;
    if (same(exposure.seconds, setting.seconds) && same(exposure.gain, setting.gain)) return &known;
  }
  return nullptr;
}

std::vector<Probe> probes_of(const Verifier& verifier) {
  std::vector<Probe> probes;
  for (const VerifiedFrame& known : verifier.verified()) {
    probes.push_back({known.frame.exposure->total(), &known.appearance});
  }
  return probes;
}

/// The device does not go as far as it says: from now on its range ends a little before what the picture looked like,
/// and when that is refused too, at the last exposure that was verified.
void narrow(Capabilities& limits, const Verifier& verifier, const ExposureSetting& refused) {
  constexpr double kBefore = 0.92;  // so precisely brightness tells an exposure
  double shortest = HUGE_VAL, longest = 0, gain = limits.gain.min;
  for (const VerifiedFrame& known : verifier.verified()) {
    shortest = std::min(shortest, known.frame.exposure->seconds);
    longest = std::max(longest, known.frame.exposure->seconds);
    gain = std::max(gain, known.frame.exposure->gain);
  }
  const double seeming = verifier.seeming_total().value_or(0);
  if (refused.gain > gain) {
    const double to = seeming / refused.seconds * kBefore;
    limits.gain.max = to > gain && to < refused.gain * kBefore ? to : gain;
  } else if (refused.seconds > longest) {
    const double to = seeming / refused.gain * kBefore;
    limits.seconds.max = to > longest && to < refused.seconds * kBefore ? to : longest;
  } else if (refused.seconds < shortest) {
    const double to = seeming / refused.gain / kBefore;
    limits.seconds.min = to < shortest && to > refused.seconds / kBefore ? to : shortest;
  }
}

class Shoot {
 public:
  Shoot(CameraDevice& camera, const BracketRequest& request, const ShootOptions& options)
      : camera_(camera), request_(request), options_(options), limits_(camera.capabilities()) {}

  Take run() {
    const ExposureSetting first = setting_near(
        request_.times.empty() ? 1.0 / 60 : *std::min_element(request_.times.begin(), request_.times.end()), limits_,
        request_.mains_hz);
    const Running running(camera_,
                          limits_.reports_exposure ? first : setting_near(1.0 / 60, limits_, request_.mains_hz));
    Verifier verifier(camera_, limits_.reports_exposure ? first : setting_near(1.0 / 60, limits_, request_.mains_hz),
                      {options_.frame_deadline, options_.max_latency, options_.on_frame});
    const auto started = camera_.now();
    verifier.prepare();
    const auto prepared = camera_.now();
    take_.prepare_seconds = seconds(prepared - started);
    if (request_.times.empty()) probe(verifier);
    make_plan(verifier);
    const auto probed = camera_.now();
    take_.probe_seconds = seconds(probed - prepared);
    take_shots(verifier);
    take_.bracket_seconds = seconds(camera_.now() - probed);
    take_.latency = verifier.latency().value_or(0);
    return std::move(take_);
  }

 private:
  static double seconds(std::chrono::steady_clock::duration duration) {
    return std::chrono::duration<double>(duration).count();
  }

  void probe(Verifier& verifier) {
    request_.response_known = request_.response_known || verifier.model().usable().linear;
    while (const auto probe = next_probe(probes_of(verifier), verifier.model(), limits_, request_.mains_hz)) {
      if (verifier.take(*probe)) continue;
      take_.warnings.push_back(verifier.why_not());
      narrow(limits_, verifier, *probe);
    }
  }

  void make_plan(const Verifier& verifier) {
    if (!request_.times.empty()) {
      take_.plan = plan_times(limits_, request_);
      return;
    }
    const std::vector<Probe> probes = probes_of(verifier);
    const LightLevels light = light_levels(probes, verifier.model());
    take_.plan = request_.grid ? plan_grid(light, limits_, request_)
                               : plan_auto(light, window_of(verifier.model()), probes, limits_, request_);
  }

  /// Those next to what is verified come first: an exposure is verified against its neighbours.
  std::vector<std::size_t> order(double from) const {
    std::vector<std::size_t> order(take_.plan.shots.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      const double to_a = std::log(take_.plan.shots[a].setting.total() / from);
      const double to_b = std::log(take_.plan.shots[b].setting.total() / from);
      return (to_a < 0) != (to_b < 0) ? to_a < 0 : std::abs(to_a) < std::abs(to_b);
    });
    return order;
  }

  void take_shots(Verifier& verifier) {
    std::vector<const VerifiedFrame*> kept(take_.plan.shots.size());
    std::size_t done = 0;
    for (const std::size_t k : order(verifier.verified().back().frame.exposure->total())) {
      const ExposureSetting& setting = take_.plan.shots[k].setting;
      kept[k] = taken_already(verifier, setting);
      if (!kept[k]) {
        kept[k] = verifier.take(setting);
        ++take_.taken;
      }
      if (!kept[k]) take_.warnings.push_back(verifier.why_not() + "; left out");
      if (options_.progress) options_.progress(++done, kept.size());
    }
    Plan& plan = take_.plan;
    std::vector<PlannedShot> shots;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      if (!kept[k]) continue;
      shots.push_back(plan.shots[k]);
      take_.frames.push_back(kept[k]->frame);
    }
    plan.shots = std::move(shots);
    if (take_.frames.empty()) {
      throw CameraError(CameraError::Kind::kTimeout,
                        limits_.uri + ": no exposure could be verified: " + take_.warnings.back());
    }
  }

  CameraDevice& camera_;
  BracketRequest request_;
  const ShootOptions& options_;
  Capabilities limits_;
  Take take_;
};

}  // namespace

Take shoot(CameraDevice& camera, const BracketRequest& request, const ShootOptions& options) {
  return Shoot(camera, request, options).run();
}

}  // namespace hdr
