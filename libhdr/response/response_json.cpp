// The response file: {"format": "hdr-response", "version": 1, "levels": 256, "g": {"R": [...], "G": [...], "B": [...]}}
// with "bits" where the depth is not 8. A file without "bits" and with 4096 samples is of a 16-bit photograph.
#include <cmath>
#include <nlohmann/json.hpp>

#include "libhdr/core/error.h"
#include "libhdr/response/response.h"

namespace hdr {
namespace {

constexpr const char* kChannelNames[3] = {"R", "G", "B"};

std::vector<double> checked_curve(const nlohmann::json& values, const std::string& where, int levels) {
  if (!values.is_array() || static_cast<int>(values.size()) != levels) {
    throw Error(where + ": has " + std::to_string(values.size()) + " values, not " + std::to_string(levels));
  }
  std::vector<double> curve;
  curve.reserve(values.size());
  for (const nlohmann::json& value : values) {
    const std::string at = where + "[" + std::to_string(curve.size()) + "]";
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      throw Error(at + ": is not a finite number; g holds natural logs of exposure");
    }
    const double g = value.get<double>();
    if (std::abs(g) > 50) throw Error(at + ": is beyond what a photograph can hold; g holds natural logs of exposure");
    if (!curve.empty() && g < curve.back()) throw Error(at + ": g decreases; a brighter code means more light");
    curve.push_back(g);
  }
  if (!(curve.back() > curve.front())) throw Error(where + ": g is flat; such a response says nothing");
  return curve;
}

}  // namespace

std::string json_from_response(const Response& response, double rms_log_error,
                               const std::array<std::vector<double>, 3>& deviation) {
  nlohmann::ordered_json json;
  json["format"] = "hdr-response";
  json["version"] = 1;
  json["bits"] = response.bits;
  json["levels"] = response.levels();
  json["rms_log_error"] = rms_log_error;
  for (std::size_t c = 0; c < 3; ++c) json["g"][kChannelNames[c]] = response.g[c];
  for (std::size_t c = 0; c < 3; ++c) {
    if (!deviation[c].empty()) json["deviation"][kChannelNames[c]] = deviation[c];
  }
  return json.dump() + "\n";
}

Response response_from_json(const std::string& text, const std::string& source) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) throw Error(source + ": not JSON; make one with `hdr calibrate`");
  const auto format = json.find("format");
  if (format == json.end() || *format != "hdr-response") {
    throw Error(source + ": not a response file (no \"format\": \"hdr-response\"); make one with `hdr calibrate`");
  }
  const auto version = json.find("version");
  if (version == json.end() || *version != 1) throw Error(source + ": version is not 1; make a new one");
  const auto levels = json.find("levels");
  if (levels == json.end() || !(*levels == 256 || *levels == 4096)) {
    throw Error(source + ": \"levels\" is neither 256 (8 bits) nor 4096 (deeper)");
  }
  Response response;
  response.bits = *levels == 256 ? 8 : 16;
  if (const auto bits = json.find("bits"); bits != json.end()) {
    if (!bits->is_number_integer() || *bits < 8 || *bits > 16 || response_levels(bits->get<int>()) != *levels) {
      throw Error(source + ": \"bits\" does not agree with \"levels\"");
    }
    response.bits = bits->get<int>();
  }
  const auto g = json.find("g");
  if (g == json.end() || !g->is_object()) throw Error(source + ": no \"g\" with R, G and B");
  for (std::size_t c = 0; c < 3; ++c) {
    const auto values = g->find(kChannelNames[c]);
    if (values == g->end()) throw Error(source + ": no g." + kChannelNames[c]);
    response.g[c] = checked_curve(*values, source + ": g." + kChannelNames[c], levels->get<int>());
    // A file made elsewhere may have another origin; ours is the middle code.
    const double middle = response.g[c][response.g[c].size() / 2];
    for (double& value : response.g[c]) value -= middle;
  }
  return response;
}

}  // namespace hdr
