#include "capture/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hdr {
namespace {

using Kind = CameraError::Kind;

/// Times and gains of one device are its own to round: exposures closer than this are the same.
constexpr double kSame = 0.01;
constexpr double kTolerance = 0.10;      ///< natural log: what a brightness may be off
constexpr double kMostDeviation = 0.20;  ///< of a ratio that still tells something
constexpr double kLadderStep = 2;
constexpr int kTriesAfterLatency = 8;  ///< frames, of which two good ones in a row are needed
constexpr int kRefusals = 2;           ///< pairs of frames that agree on another exposure
constexpr double kWorthASecond = 1;    ///< seconds: where metadata are enough, a longer frame is not taken twice
constexpr double kBridge = 0.7;        ///< EV: steps that short need no exposure between them
constexpr int kAttempts = 3;           ///< at exposures that the device follows

std::chrono::steady_clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
}

/// nullopt for a frame that is short or cannot be decoded, which nobody marked.
std::optional<Appearance> look(const Frame& frame) {
  if (!frame.is_whole()) return std::nullopt;
  try {
    return appearance_of(frame);
  } catch (const CameraError&) {
    throw;
  } catch (const Error&) {
    return std::nullopt;
  }
}

bool same(double total, double other) {
  return std::abs(std::log(total / other)) < kSame;
}

/// Half of the samples tell something.
bool shows_something(const Appearance& appearance) {
  return appearance.clipped() < 0.5 && appearance.dark() < 0.5;
}

}  // namespace

ExposureSetting setting_for_total(double total, const Capabilities& limits) {
  ExposureSetting setting;
  setting.seconds = limits.seconds.snap(total / limits.gain.min);
  setting.gain = limits.gain.min;
  // A time that was rounded to the device's step is as near as it gets; one at the limit needs gain.
  if (total > limits.seconds.max * limits.gain.min) setting.gain = limits.gain.snap(total / setting.seconds);
  return setting;
}

Verifier::Verifier(CameraDevice& camera, const ExposureSetting& first, VerifyOptions options)
    : camera_(camera),
      options_(std::move(options)),
      limits_(camera.capabilities()),
      set_(first),
      set_at_(camera.now()),
      in_flight_seconds_(first.seconds) {}

const BrightnessModel& Verifier::model() const {
  HDR_ASSERT(model_.has_value());
  return *model_;
}

void Verifier::set(const ExposureSetting& setting) {
  camera_.set(setting);
  in_flight_seconds_ = set_.seconds;
  set_ = setting;
  set_at_ = camera_.now();
  set_sequence_ = last_sequence_;
}

Frame Verifier::next() {
  const double longest = std::max({set_.seconds, in_flight_seconds_, limits_.frame_seconds});
  // Frames get lost: the deadline is for one that comes after two of those.
  Frame frame = camera_.next_frame(camera_.now() + duration_of(3 * longest) + options_.frame_deadline);
  if (options_.on_frame) options_.on_frame(frame);
  last_sequence_ = frame.sequence;
  if (!any_frame_) set_sequence_ = frame.sequence - 1;
  any_frame_ = true;
  return frame;
}

int Verifier::since_set(const Frame& frame) const {
  return static_cast<int>(frame.sequence - set_sequence_) - 1;
}

/// The second of the first two frames in a row that agree, after `skip` frames and within `tries` more.
std::optional<Verifier::Sight> Verifier::settled(int skip, int tries) {
  std::optional<Sight> before;
  for (int k = 0; k < tries;) {
    Frame frame = next();
    const int since = since_set(frame);
    if (since < skip) continue;
    ++k;
    std::optional<Appearance> appearance = look(frame);
    if (!appearance) continue;
    Sight sight{std::move(frame), std::move(*appearance), since};
    if (before && agree(before->appearance, sight.appearance)) return sight;
    before = std::move(sight);
  }
  return std::nullopt;
}

/// A frame that shows something, whatever exposure that takes; where it may not be longer, one that is not clipped.
Verifier::Sight Verifier::first_sight(bool may_be_longer) {
  // The latency is not known yet: wait for the longest there is.
  const auto settle = [&]() -> Sight {
    std::optional<Sight> sight = settled(options_.max_latency + 1, 2 * kTriesAfterLatency);
    if (!sight) {
      throw CameraError(Kind::kTimeout, limits_.uri +
                                            ": no two frames of one exposure agree; does the light flicker, or "
                                            "does the camera move?");
    }
    return std::move(*sight);
  };
  Sight sight = settle();
  double factor = 8;
  bool was_clipped = false, was_dark = false;
  for (int k = 0; k < 8 && !shows_something(sight.appearance); ++k) {
    const bool clipped = sight.appearance.clipped() >= 0.5;
    if (!clipped && !may_be_longer) break;
    if (clipped ? was_dark : was_clipped) factor = std::sqrt(factor);
    (clipped ? was_clipped : was_dark) = true;
    const ExposureSetting other = setting_for_total(clipped ? set_.total() / factor : set_.total() * factor, limits_);
    if (same(other.total(), set_.total())) break;  // at the device's limit
    set(other);
    const Appearance before = std::move(sight.appearance);
    sight = settle();
    if (!clipped && agree(before, sight.appearance)) break;  // it does not get brighter
  }
  return sight;
}

/// The step that finds the latency. False when the picture moved, but not as it should.
bool Verifier::step_from(const Sight& base, double factor) {
  const ExposureSetting from = set_, to = setting_for_total(set_.total() * factor, limits_);
  const double asked = std::log(to.total() / from.total());
  set(to);
  double seen = 0;
  bool told = false;
  std::optional<Sight> moved;
  for (int k = 0; k <= options_.max_latency + kTriesAfterLatency; ++k) {
    Frame frame = next();
    const int since = since_set(frame);
    std::optional<Appearance> appearance = look(frame);
    if (!appearance) continue;
    Sight sight{std::move(frame), std::move(*appearance), since};
    const auto ratio = model_->ratio(base.appearance, sight.appearance);
    if (!ratio) continue;
    told = true;
    seen = ratio->ln_ratio;
    if (seen / asked < 0.4) continue;
    if (!moved) latency_ = std::min(latency_.value_or(sight.since_set), sight.since_set);
    if (moved && agree(moved->appearance, sight.appearance)) {
      if (std::abs(seen - asked) > std::max(kTolerance, 2 * ratio->deviation)) break;
      if (!nearest(from.total(), 1).empty() &&
          same(nearest(from.total(), 1)[0]->frame.exposure->total(), from.total())) {
        keep(std::move(sight), to, Verified::kBrightness);
      } else {
        Sight first{base.frame, base.appearance, 0};
        keep(std::move(first), from, Verified::kBrightness);
        keep(std::move(sight), to, Verified::kBrightness);
      }
      return true;
    }
    moved = std::move(sight);
  }
  if (!told && verified_.empty() && why_not_.empty()) {
    throw CameraError(Kind::kTimeout, limits_.uri +
                                          ": the picture is black or clipped all over, so its exposure cannot be "
                                          "told; is the lens open?");
  }
  if (told) why_not_ = fmt::format("{:.2g} times was asked, {:.2g} times was seen", std::exp(asked), std::exp(seen));
  return false;
}

void Verifier::prepare() {
  if (limits_.reports_exposure) {
    const ExposureSetting first = set_;
    if (!take(first)) throw CameraError(Kind::kTimeout, limits_.uri + ": " + why_not_);
    return;
  }
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    verified_.clear();
    const Sight base = first_sight(attempt == 0);
    model_.emplace(base.appearance.usable);
    const double level = (base.appearance.green().quantile(0.5) - base.appearance.usable.black) /
                         (base.appearance.usable.white - base.appearance.usable.black);
    const ExposureSetting start = set_;
    const auto reachable = [&](double factor) {
      return same(setting_for_total(start.total() * factor, limits_).total(), start.total() * factor);
    };
    double factor = level < 0.35 ? kLadderStep : 1 / kLadderStep;
    if (!reachable(factor * factor)) factor = 1 / factor;
    // A clamp leaves at most one step that is neither whole nor nothing: two equal steps are both as asked.
    if (step_from(base, factor) && (take(setting_for_total(start.total() * factor * factor, limits_)) ||
                                    take(setting_for_total(start.total() / factor, limits_)))) {
      return;
    }
    // The device clamps here, and says nothing: shorter exposures are where it does not.
    const ExposureSetting shorter = setting_for_total(start.total() / 16, limits_);
    if (same(shorter.total(), start.total())) break;
    set(shorter);
  }
  throw CameraError(
      Kind::kNotSupported,
      fmt::format("{}: the picture does not follow the exposure ({}); turn automatic exposure off, and keep "
                  "the light steady",
                  limits_.uri, why_not_));
}

std::vector<const VerifiedFrame*> Verifier::nearest(double total, std::size_t count) const {
  std::vector<const VerifiedFrame*> frames;
  for (const VerifiedFrame& frame : verified_) frames.push_back(&frame);
  std::stable_sort(frames.begin(), frames.end(), [total](const VerifiedFrame* a, const VerifiedFrame* b) {
    return std::abs(std::log(a->frame.exposure->total() / total)) <
           std::abs(std::log(b->frame.exposure->total() / total));
  });
  if (frames.size() > count) frames.resize(count);
  return frames;
}

const VerifiedFrame* Verifier::keep(Sight&& sight, const ExposureSetting& exposure, Verified how) {
  for (const VerifiedFrame* known : nearest(exposure.total(), 2)) {
    model_->learn(known->appearance, sight.appearance, std::log(exposure.total() / known->frame.exposure->total()));
  }
  sight.frame.detach();
  sight.frame.exposure = exposure;
  sight.frame.verified = how;
  verified_.push_back({std::move(sight.frame), std::move(sight.appearance)});
  return &verified_.back();
}

/// Against the kept frame that tells most.
Verifier::Verdict Verifier::judge(const Appearance& appearance, const ExposureSetting& setting,
                                  double& seeming_total) const {
  std::optional<BrightnessModel::Ratio> best;
  double best_total = 0;
  for (const VerifiedFrame* known : nearest(setting.total(), 3)) {
    const auto ratio = model_->ratio(known->appearance, appearance);
    if (ratio && (!best || ratio->deviation < best->deviation)) {
      best = ratio;
      best_total = known->frame.exposure->total();
    }
  }
  if (!best || best->deviation > kMostDeviation) return Verdict::kCannotTell;
  seeming_total = best_total * std::exp(best->ln_ratio);
  const double off = std::abs(std::log(seeming_total / setting.total()));
  return off <= std::max(kTolerance, 2 * best->deviation) ? Verdict::kAsAsked : Verdict::kOther;
}

const VerifiedFrame* Verifier::take(const ExposureSetting& setting) {
  const ExposureSetting snapped{limits_.seconds.snap(setting.seconds), limits_.gain.snap(setting.gain)};
  why_not_.clear();
  seeming_total_.reset();
  return limits_.reports_exposure ? take_by_metadata(snapped) : take_by_brightness(snapped, 3);
}

const VerifiedFrame* Verifier::take_by_metadata(const ExposureSetting& setting) {
  const bool change = !verified_.empty() && !same(set_.total(), setting.total());
  set(setting);
  std::optional<ExposureSetting> reported;
  std::optional<Sight> before;
  for (int arrivals = 0; arrivals < options_.max_latency + kTriesAfterLatency; ++arrivals) {
    Frame frame = next();
    if (!frame.reported) continue;
    reported = frame.reported;
    if (frame.timestamp < set_at_.time_since_epoch() || !same(reported->total(), setting.total())) continue;
    const int since = since_set(frame);
    if (change) latency_ = std::min(latency_.value_or(since), since);
    std::optional<Appearance> appearance = look(frame);
    if (!appearance) continue;
    Sight sight{std::move(frame), std::move(*appearance), since};
    if (set_.seconds <= kWorthASecond && !(before && agree(before->appearance, sight.appearance))) {
      before = std::move(sight);
      continue;
    }
    if (!model_) model_.emplace(sight.appearance.usable);
    return keep(std::move(sight), *reported, Verified::kMetadata);
  }
  if (reported) {
    seeming_total_ = reported->total();
    why_not_ = fmt::format("{:.4g} s at gain {:.3g} was asked and the camera reports {:.4g} s at gain {:.3g}",
                           setting.seconds, setting.gain, reported->seconds, reported->gain);
  } else {
    why_not_ = "no whole frame came with its exposure";
  }
  return nullptr;
}

const VerifiedFrame* Verifier::take_by_brightness(const ExposureSetting& setting, int bridges) {
  set(setting);
  std::optional<Sight> before;
  bool told = false, agreed = false;
  int refusals = 0;
  double seeming = 0;
  const int skip = latency_.value_or(0);
  const bool learning = verified_.size() < 3;  // the latency may have been measured on a frame that was lost
  for (int k = 0; k < kTriesAfterLatency + (learning ? skip : 0);) {
    Frame frame = next();
    const int since = since_set(frame);
    if (since < skip && !learning) continue;
    ++k;
    if (frame.timestamp < set_at_.time_since_epoch()) continue;
    std::optional<Appearance> appearance = look(frame);
    if (!appearance) continue;
    Sight sight{std::move(frame), std::move(*appearance), since};
    if (before && agree(before->appearance, sight.appearance)) {
      agreed = true;
      const Verdict verdict = judge(sight.appearance, setting, seeming);
      if (verdict == Verdict::kAsAsked) {
        if (learning) latency_ = std::min(skip, before->since_set);
        return keep(std::move(sight), setting, Verified::kBrightness);
      }
      told = verdict == Verdict::kOther;
      // Pairs of frames that are as old as the latency allows do not count: it may have been a frame more this time.
      if (told && since > skip + 1 && ++refusals >= kRefusals && !learning) break;
      if (verdict == Verdict::kCannotTell && since > skip) break;
    }
    before = std::move(sight);
  }
  if (told) {
    seeming_total_ = seeming;
    why_not_ = fmt::format("{:.4g} s at gain {:.3g} was asked and the picture looks like {:.4g} s", setting.seconds,
                           setting.gain, seeming / setting.gain);
    return nullptr;
  }
  if (!agreed) {
    why_not_ = fmt::format("no two frames of {:.4g} s agree; does the light flicker, or does something move?",
                           setting.seconds);
    return nullptr;
  }
  // Too far from what is known: an exposure between them may have codes in common with both.
  const double known = nearest(setting.total(), 1)[0]->frame.exposure->total();
  if (bridges > 0 && std::abs(std::log2(setting.total() / known)) > kBridge) {
    const ExposureSetting between = setting_for_total(std::sqrt(setting.total() * known), limits_);
    if (take_by_brightness(between, bridges - 1)) return take_by_brightness(setting, bridges - 1);
  }
  why_not_ = fmt::format("the picture of {:.4g} s is black or clipped all over, so its exposure cannot be told",
                         setting.seconds);
  return nullptr;
}

}  // namespace hdr
