#pragma once
// Frames whose exposure is known. Asking a device for an exposure is no proof that it has it: devices clamp in silence,
// go on metering, take some frames until they obey, and read back what they were told. So a frame is kept when
//   the device says with the frame itself what it was exposed with (metadata), and, up to 1 s, the next frame agrees;
//   or its timestamp is after the change, the picture moved as far as the asked exposure must move it, and the next
//   frame agrees (brightness).
// With an unknown response one step of brightness proves little: a gamma of 2 and a step of 1 EV look like linear light
// and 2 EV. Two equal steps that look equal do: prepare() takes three exposures, t, 2t, 4t, and from there on each kept
// frame teaches the response (brightness.h). A ratio is then told to about 4 % for a step within the codes that were
// seen; what is 10 % (or, where that is more, two of its own standard deviations) off is refused, and so is what can
// be told to less than 20 %.
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capture/appearance.h"
#include "capture/brightness.h"
#include "capture/camera.h"

namespace hdr {

struct VerifyOptions {
  std::chrono::milliseconds frame_deadline{5000};  ///< for each frame, beyond its exposure
  int max_latency = 8;                             ///< frames that may still show an older exposure
  std::function<void(const Frame&)> on_frame;      ///< every frame that arrives, kept or not
};

/// A frame with Frame::exposure, and what it looks like.
struct VerifiedFrame {
  Frame frame;  ///< detached
  Appearance appearance;
};

class Verifier {
 public:
  /// `camera` runs since start(first).
  Verifier(CameraDevice& camera, const ExposureSetting& first, VerifyOptions options = {});

  /// Finds an exposure that shows something, the latency and the response, once for a device. Frames taken for it are
  /// in verified(). Throws CameraError kNotSupported when the picture does not follow the exposure.
  void prepare();

  /// One frame with this exposure; a reference that lasts as long as the Verifier. nullptr, with the reason in
  /// why_not(), when there is none to be had: the device clamped it, or the picture cannot tell (black or clipped all
  /// over). Throws what the camera throws.
  const VerifiedFrame* take(const ExposureSetting& setting);

  const std::string& why_not() const { return why_not_; }
  /// Where the device did not follow: the total exposure that the last frames seemed to have.
  std::optional<double> seeming_total() const { return seeming_total_; }
  std::optional<int> latency() const { return latency_; }  ///< frames; known after prepare()
  const std::deque<VerifiedFrame>& verified() const { return verified_; }
  const BrightnessModel& model() const;

 private:
  enum class Verdict { kAsAsked, kOther, kCannotTell };
  struct Sight {
    Frame frame;
    Appearance appearance;
    int since_set = 0;  ///< frames between set() and this one, those that were lost included
  };

  void set(const ExposureSetting& setting);
  Frame next();
  int since_set(const Frame& frame) const;
  std::optional<Sight> settled(int skip, int tries);
  Sight first_sight(bool may_be_longer);
  bool step_from(const Sight& base, double factor);
  Verdict judge(const Appearance& appearance, const ExposureSetting& setting, double& seeming_total) const;
  std::vector<const VerifiedFrame*> nearest(double total, std::size_t count) const;
  const VerifiedFrame* keep(Sight&& sight, const ExposureSetting& exposure, Verified how);
  const VerifiedFrame* take_by_metadata(const ExposureSetting& setting);
  const VerifiedFrame* take_by_brightness(const ExposureSetting& setting, int bridges);

  CameraDevice& camera_;
  VerifyOptions options_;
  Capabilities limits_;
  ExposureSetting set_;
  std::chrono::steady_clock::time_point set_at_;
  double in_flight_seconds_;  ///< the longest exposure of frames that may still come
  std::uint32_t last_sequence_ = 0, set_sequence_ = 0;
  bool any_frame_ = false;
  std::optional<BrightnessModel> model_;
  std::deque<VerifiedFrame> verified_;
  std::optional<int> latency_;
  std::optional<double> seeming_total_;
  std::string why_not_;
};

/// The setting with this product of seconds and gain, snapped to the device: gain only where the time is at its limit.
ExposureSetting setting_for_total(double total, const Capabilities& limits);

}  // namespace hdr
