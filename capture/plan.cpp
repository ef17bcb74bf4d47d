#include "capture/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

constexpr double kStop = std::numbers::ln2;
/// What brightness does not tell of the response, at each end of a shot's window.
constexpr double kMargin = 0.15 * kStop;
constexpr double kProbeStep = 8;
/// Shots closer than this are one.
constexpr double kApart = kStop / 3;
constexpr double kOffGrid =
    kStop / 3;  ///< either side of the middle between two shots: their distances differ by 2/3 EV

/// The planner's view: which shots show which samples.
class Coverage {
 public:
  Coverage(const LightLevels& light, const Window& window, const Capabilities& limits, const BracketRequest& request)
      : light_(light.ln_light), window_(window), limits_(limits), mains_hz_(request.mains_hz) {
    const auto tail = static_cast<std::size_t>(kLostShare * static_cast<double>(light_.size()));
    // One sample in hand: less than the share, not just the share.
    first_ = tail > 0 ? tail - 1 : 0;
    last_ = light_.size() - first_;
    // What the device cannot reach is nobody's task.
    const double darkest = window.floor - std::log(shortest_or_longest(true));
    const double brightest = window.ceiling - std::log(shortest_or_longest(false));
    while (first_ < last_ && light_[first_] < darkest) ++first_;
    while (last_ > first_ && light_[last_ - 1] > brightest) --last_;
  }

  Coverage with_margin(double margin) const {
    Coverage narrower = *this;
    narrower.window_ = {window_.floor + margin, window_.ceiling - margin};
    return narrower;
  }

  bool shows(double total, double ln_light) const {
    const double exposure = ln_light + std::log(total);
    return exposure >= window_.floor && exposure <= window_.ceiling;
  }

  /// The fewest exposures, each as long as it may be: from the brightest sample downwards. An optimal cover of points
  /// on a line by windows of one width.
  std::vector<ExposureSetting> longest_cover() const {
    std::vector<ExposureSetting> shots;
    for (std::size_t k = last_; k > first_;) {
      const ExposureSetting shot = setting_at_most(std::exp(window_.ceiling - light_[k - 1]), limits_, mains_hz_);
      std::size_t next = k;
      while (next > first_ && light_[next - 1] + std::log(shot.total()) >= window_.floor) --next;
      if (next == k) {
        --k;  // between two exposures that the device has: none shows it
        continue;
      }
      shots.push_back(shot);
      k = next;
    }
    return shots;
  }

  /// The same, each as short as it may be: from the darkest sample upwards.
  std::vector<ExposureSetting> shortest_cover() const {
    std::vector<ExposureSetting> shots;
    for (std::size_t k = first_; k < last_;) {
      const ExposureSetting shot = setting_at_least(std::exp(window_.floor - light_[k]), limits_, mains_hz_);
      std::size_t next = k;
      while (next < last_ && light_[next] + std::log(shot.total()) <= window_.ceiling) ++next;
      if (next == k) {
        ++k;
        continue;
      }
      shots.push_back(shot);
      k = next;
    }
    std::reverse(shots.begin(), shots.end());
    return shots;
  }

  /// Samples of the task that no shot shows.
  std::size_t missed(const std::vector<ExposureSetting>& shots) const {
    std::size_t missed = 0;
    for (std::size_t k = first_; k < last_; ++k) {
      missed += std::none_of(shots.begin(), shots.end(),
                             [&](const ExposureSetting& shot) { return shows(shot.total(), light_[k]); });
    }
    return missed;
  }

  double share_shown(double total) const {
    const auto count = std::count_if(light_.begin(), light_.end(), [&](double light) { return shows(total, light); });
    return static_cast<double>(count) / static_cast<double>(light_.size());
  }
  double share_above(double total) const {
    const auto above = std::upper_bound(light_.begin(), light_.end(), window_.ceiling - std::log(total));
    return static_cast<double>(light_.end() - above) / static_cast<double>(light_.size());
  }
  double share_below(double total) const {
    const auto below = std::lower_bound(light_.begin(), light_.end(), window_.floor - std::log(total));
    return static_cast<double>(below - light_.begin()) / static_cast<double>(light_.size());
  }
  double shortest_or_longest(bool longest) const {
    return longest ? setting_at_most(HUGE_VAL, limits_, mains_hz_).total()
                   : setting_at_least(0, limits_, mains_hz_).total();
  }

 private:
  std::vector<double> light_;
  Window window_;
  Capabilities limits_;
  std::optional<double> mains_hz_;
  std::size_t first_ = 0, last_ = 0;  ///< the samples that shots must show
};

bool apart(const std::vector<ExposureSetting>& shots, double total) {
  return std::none_of(shots.begin(), shots.end(), [total](const ExposureSetting& shot) {
    return std::abs(std::log(shot.total() / total)) < kApart;
  });
}

void sort(std::vector<ExposureSetting>& shots) {
  std::stable_sort(shots.begin(), shots.end(),
                   [](const ExposureSetting& a, const ExposureSetting& b) { return a.total() < b.total(); });
}

/// Shots of the least number: in the middle of where they may stand, at probes where those are there already.
/// `careful` is the view with margins, `seen` the one without: neither may get worse.
std::vector<ExposureSetting> fewest(const Coverage& careful, const Coverage& seen, const std::vector<Probe>& probes,
                                    const Capabilities& limits, const BracketRequest& request) {
  std::vector<ExposureSetting> shots = careful.longest_cover();
  const std::vector<ExposureSetting> shortest = careful.shortest_cover();
  const std::size_t missed = careful.missed(shots), missed_at_all = seen.missed(shots);
  const auto as_good = [&](const std::vector<ExposureSetting>& others) {
    return careful.missed(others) <= missed && seen.missed(others) <= missed_at_all;
  };
  if (shortest.size() != shots.size()) return shots;
  // Between two covers there is another, except where an empty range of light makes shots change their tasks.
  std::vector<ExposureSetting> middle;
  for (std::size_t k = 0; k < shots.size(); ++k) {
    middle.push_back(setting_near(std::sqrt(shots[k].total() * shortest[k].total()), limits, request.mains_hz));
  }
  if (as_good(middle)) shots = middle;
  for (ExposureSetting& shot : shots) {
    const ExposureSetting planned = shot;
    double nearest = HUGE_VAL;
    for (const Probe& probe : probes) {
      const ExposureSetting there = setting_near(probe.total, limits, request.mains_hz);
      const double distance = std::abs(std::log(probe.total / planned.total()));
      if (distance >= nearest || std::abs(std::log(there.total() / probe.total)) > 0.01) continue;
      const ExposureSetting before = shot;
      shot = there;
      if (as_good(shots)) {
        nearest = distance;
      } else {
        shot = before;
      }
    }
  }
  return shots;
}

/// One exposure more, for the response: between the two neighbours whose common samples are most, not in their middle.
/// A lone shot gets a neighbour at 2 2/3 EV, on the side where more is seen.
std::optional<ExposureSetting> off_grid(const std::vector<ExposureSetting>& shots, const Coverage& coverage,
                                        const std::vector<Probe>& probes, const Capabilities& limits,
                                        const BracketRequest& request) {
  std::vector<double> wanted;
  if (shots.size() == 1) {
    const double away = 8 * kStop / 3;
    wanted = {shots[0].total() * std::exp(-away), shots[0].total() * std::exp(away)};
    for (const Probe& probe : probes) {
      const double distance = std::abs(std::log(probe.total / shots[0].total()));
      if (distance > 0.9 * kStop && distance < 4 * kStop) wanted.push_back(probe.total);
    }
  }
  for (std::size_t k = 0; k + 1 < shots.size(); ++k) {
    const double middle = std::sqrt(shots[k].total() * shots[k + 1].total());
    const double half = std::log(shots[k + 1].total() / middle);
    const double off = std::min(kOffGrid, half / 3);
    wanted.insert(wanted.end(), {middle * std::exp(off), middle * std::exp(-off)});
    for (const Probe& probe : probes) {  // it is there already
      const double distance = std::abs(std::log(probe.total / middle));
      if (distance >= off && distance <= half / 2) wanted.push_back(probe.total);
    }
  }
  std::optional<ExposureSetting> best;
  double most = 0;
  for (const double total : wanted) {
    const ExposureSetting candidate = setting_near(total, limits, request.mains_hz);
    if (!apart(shots, candidate.total())) continue;
    const bool there = std::any_of(probes.begin(), probes.end(), [&](const Probe& probe) {
      return std::abs(std::log(probe.total / candidate.total())) < 0.01;
    });
    const double shown = coverage.share_shown(candidate.total()) * (there ? 1.1 : 1.0);
    if (shown > most) {
      most = shown;
      best = candidate;
    }
  }
  return best;
}

std::string percent(double share) {
  return fmt::format("{:.2g} %", 100 * share);
}

void explain(Plan& plan, const Coverage& coverage, const Capabilities& limits) {
  if (plan.shots.empty()) return;
  const double shortest = plan.shots.front().setting.total(), longest = plan.shots.back().setting.total();
  const double clipped = coverage.share_above(shortest), dark = coverage.share_below(longest);
  plan.bright_end_lost = clipped > kLostShare;
  plan.dark_end_lost = dark > kLostShare;
  if (plan.bright_end_lost) {
    plan.notes.push_back(
        fmt::format("the bright end is lost: {} of the samples clip in {:.3g} s, and the device exposes for "
                    "{:.3g} s at least",
                    percent(clipped), plan.shots.front().setting.seconds, limits.seconds.min));
  }
  if (plan.dark_end_lost) {
    plan.notes.push_back(
        fmt::format("the dark end is lost: {} of the samples are noise in {:.3g} s at gain {:.3g}, and the "
                    "device exposes for {:.3g} s at gain {:.3g} at most",
                    percent(dark), plan.shots.back().setting.seconds, plan.shots.back().setting.gain,
                    limits.seconds.max, limits.gain.max));
  }
}

}  // namespace

std::optional<ExposureSetting> next_probe(const std::vector<Probe>& probes, const BrightnessModel& model,
                                          const Capabilities& limits, std::optional<double> mains_hz) {
  const LightLevels light = light_levels(probes, model);
  const auto [shortest, longest] = std::minmax_element(
      probes.begin(), probes.end(), [](const Probe& a, const Probe& b) { return a.total < b.total; });
  if (light.clipped > kLostShare) {
    const ExposureSetting probe = setting_near(shortest->total / kProbeStep, limits, mains_hz);
    if (probe.total() < shortest->total * 0.9) return probe;
  }
  if (light.black > kLostShare) {
    const ExposureSetting probe = setting_near(longest->total * kProbeStep, limits, mains_hz);
    if (probe.total() > longest->total * 1.1) return probe;
  }
  return std::nullopt;
}

Plan plan_auto(const LightLevels& light, const Window& window, const std::vector<Probe>& probes,
               const Capabilities& limits, const BracketRequest& request) {
  const Coverage seen(light, window, limits, request), careful = seen.with_margin(kMargin);
  // Where the margins cost a shot, that one is the one more.
  const std::size_t least = seen.with_margin(-kMargin).longest_cover().size();
  std::vector<ExposureSetting> shots = fewest(careful, seen, probes, limits, request);
  // A scene that is beyond the device, or that nothing of can be told: what the device has nearest to it.
  if (shots.empty()) {
    const double middle = light.ln_light[light.ln_light.size() / 2];
    shots = {setting_near(std::exp((window.floor + window.ceiling) / 2 - middle), limits, request.mains_hz)};
  }
  Plan plan;
  std::optional<ExposureSetting> extra;
  if (!request.response_known && shots.size() <= std::max<std::size_t>(least, 1)) {
    extra = off_grid(shots, careful, probes, limits, request);
    if (extra) shots.push_back(*extra);
  }
  sort(shots);
  for (std::size_t k = 0; k < shots.size(); ++k) {
    const double total = shots[k].total();
    std::string reason;
    if (extra && shots[k] == *extra) {
      reason = fmt::format("off the grid of the others: the response is not known; shows {} of the samples",
                           percent(seen.share_shown(total)));
    } else if (k == 0) {
      reason =
          fmt::format("the shortest that is needed: {} of the samples clip in it", percent(seen.share_above(total)));
    } else {
      const double before = seen.share_below(shots[k - 1].total()), here = seen.share_below(total);
      reason = fmt::format("shows {} of the samples that are noise in the shorter ones",
                           percent(std::max(0.0, before - here)));
    }
    plan.shots.push_back({shots[k], reason});
  }
  explain(plan, seen, limits);
  return plan;
}

Plan plan_grid(const LightLevels& light, const Capabilities& limits, const BracketRequest& request) {
  const BracketRequest::Grid grid = request.grid.value();
  if (grid.count < 1 || !(grid.stops > 0))
    throw Error("a grid of exposures has one shot or more, and more than 0 stops");
  const double median = light.ln_light[light.ln_light.size() / 2];
  const double middle = std::exp(std::log(0.18) - median);
  Plan plan;
  for (int k = 0; k < grid.count; ++k) {
    const double stops = grid.stops * (k - 0.5 * (grid.count - 1));
    const double wanted = middle * std::exp2(stops);
    const ExposureSetting setting = setting_near(wanted, limits, request.mains_hz);
    if (std::abs(std::log2(setting.total() / wanted)) > 0.5) {
      plan.notes.push_back(
          fmt::format("{:+.3g} EV needs {:.3g} s, which is beyond the device; left out", stops, wanted));
      continue;
    }
    const bool twice = !plan.shots.empty() && plan.shots.back().setting == setting;
    if (!twice) plan.shots.push_back({setting, fmt::format("{:+.3g} EV about the scene's middle", stops)});
  }
  return plan;
}

Plan plan_times(const Capabilities& limits, const BracketRequest& request) {
  Plan plan;
  for (const double seconds : request.times) {
    const ExposureSetting setting{limits.seconds.snap(seconds), limits.gain.min};
    if (std::abs(std::log(setting.seconds / seconds)) > 0.2) {
      plan.notes.push_back(fmt::format("{:.4g} s was asked, and the device exposes for {:.4g} to {:.4g} s", seconds,
                                       limits.seconds.min, limits.seconds.max));
    }
    // Given times are kept, whatever the lamps.
    const ExposureSetting steady = setting_near(setting.total(), limits, request.mains_hz);
    if (request.mains_hz && std::abs(std::log(steady.total() / setting.total())) > 0.02) {
      plan.notes.push_back(fmt::format("{:.4g} s is no multiple of the lamps' flicker and may show bands; {:.4g} s is",
                                       setting.seconds, steady.seconds));
    }
    plan.shots.push_back({setting, "the times were given"});
  }
  return plan;
}

}  // namespace hdr
