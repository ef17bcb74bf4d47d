#pragma once
// The camera's response: f(exposure) = code. We keep g(Z) = ln f^-1(Z), the log exposure that gave code Z [Debevec97
// eq. 2], with g = 0 at the middle code 2^(bits-1) in each channel: exposures are relative, and so is white balance.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"

namespace hdr {

/// g sampled at `levels` codes: 256 for 8 bits (sample k = code k); 4096 for deeper photographs (sample k = code
/// k 2^(bits-12)). Between samples and beyond the last one the exposure exp(g) is linear in the code. Nondecreasing.
///
/// Code 0 has no single exposure: it is what rounds to no light. g(0) stands for the middle of that cell, half the
/// exposure at which code 1/2 is reached, so it is finite. A curve that starts flat has a black level: scans of film
/// and some cameras never write less than a pedestal, and all codes up to it mean what code 0 means.
struct Response {
  int bits = 8;
  std::array<std::vector<double>, 3> g;  ///< natural logs, R G B

  int levels() const { return static_cast<int>(g[0].size()); }
  double code_from_level(int level) const;             ///< the code at which sample `level` stands
  double ln_exposure(int channel, double code) const;  ///< g(code), code in [0, 2^bits - 1]
  double exposure(int channel, double code) const;     ///< exp(g(code))
  /// exp(g) for every code 0 .. 2^bits - 1, for table-driven loops.
  std::vector<float> exposure_table(int channel) const;
  int black_code(int channel) const;  ///< the last code that means no light: 0, or the end of the flat start
  /// exposure_thresholds()[k] is the exposure that stands half-way, in code, between k and k+1: less than it gives
  /// code k or below. 2^bits - 1 of them, nondecreasing.
  std::vector<double> exposure_thresholds(int channel) const;
};

Response linear_response(int bits);
Response srgb_response(int bits);
Response gamma_response(int bits, double gamma);
/// A film-like curve with a toe and a shoulder, different in each channel: the camera of `simulate --response film`.
Response film_response(int bits);

/// "linear", "srgb", "gamma:2.2", "film". nullopt for any other text (a file name).
std::optional<Response> response_from_name(const std::string& name, int bits);

/// {"format": "hdr-response", "version": 1, "levels": N, "g": {...}, ...}, with the standard deviation of g where it is
/// known; errors name `source`.
std::string json_from_response(const Response& response, double rms_log_error = 0,
                               const std::array<std::vector<double>, 3>& deviation = {});
Response response_from_json(const std::string& json, const std::string& source);

/// Samples of g that a photograph of this depth has: 256 or 4096.
int response_levels(int bits);

}  // namespace hdr
