#pragma once
// The simulated sensor: settings reach the picture a few frames late, are clamped to the frame's duration when the
// frame rate is fixed, and the picture is what they give of the scene.
#include <cstdint>
#include <deque>
#include <random>
#include <vector>

namespace hdr::sim {

enum class Encoding { kYuyv, kBayer10Packed, kBayer16, kGrey8 };

/// Code of no light in the Bayer encodings, as a part of full scale: sensors keep a pedestal so that noise is not cut.
inline constexpr double kBayerBlack = 1.0 / 16;

/// Exposure times are in UVC's units of 100 us; gains in 1/16.
struct Settings {
  bool auto_exposure = true;
  bool dynamic_frame_rate = true;
  std::uint32_t exposure_100us = 156;
  std::uint16_t gain_16ths = 16;
  std::uint16_t brightness = 128;  ///< 128 adds nothing to luma
  bool auto_white_balance = true;
  std::uint16_t white_balance_kelvin = 4600;
};

struct SensorOptions {
  int latency = 2;  ///< frames between a setting and the first frame that obeys it
  bool noise = false;
  std::uint64_t seed = 1;
  std::uint32_t min_exposure_100us = 1, max_exposure_100us = 10000;
};

class Sensor {
 public:
  explicit Sensor(const SensorOptions& options) : options_(options), random_(options.seed) {}

  const SensorOptions& options() const { return options_; }
  Settings settings;  ///< what the host asked; frames follow later

  /// A new stream begins: no frame is on its way.
  void restart() { on_the_way_.clear(); }
  /// Takes one frame with the settings that have arrived by now, and returns them.
  Settings expose(double interval_seconds);
  /// The picture of the last expose().
  std::vector<std::uint8_t> picture(Encoding encoding, int width, int height);

 private:
  float sense(float radiance);
  void encode_patch(Encoding encoding, int column, int row, int width, int height, std::vector<std::uint8_t>& out);

  SensorOptions options_;
  std::mt19937_64 random_;
  std::deque<Settings> on_the_way_;
  Settings used_;
};

/// Bytes of a picture.
std::size_t picture_bytes(Encoding encoding, int width, int height);

}  // namespace hdr::sim
