#pragma once
// What the tests of the command share: a small world to photograph, and answers as JSON.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "libhdr/core/sphere.h"
#include "libhdr/io/write.h"
#include "tests/support/support.h"

namespace hdr::test {

using Json = nlohmann::json;

/// A lat-long with sky, ground, coloured tiles and a sun: 10 stops, nothing alike left and right or up and down.
inline void write_world(const std::filesystem::path& path, int width = 256) {
  RadianceMap map;
  map.rgb = Image<float>(width, width / 2, 3);
  map.projection = "latlong";
  const Vec3 sun = Vec3(0.5, 0.6, 0.4).normalized();
  for (int y = 0; y < map.rgb.height(); ++y) {
    for (int x = 0; x < width; ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / width, (y + 0.5) / map.rgb.height());
      const double tile = std::sin(9 * d.x() + 1) * std::sin(7 * d.y()) * std::sin(8 * d.z() + 2) > 0 ? 1.0 : 0.45;
      const double sky = d.y() > 0 ? 1.2 : 0.25;
      const double glow = 200 * std::exp(400 * (d.dot(sun) - 1));
      map.rgb(x, y, 0) = static_cast<float>(sky * tile * (1 + 0.3 * d.x()) + glow);
      map.rgb(x, y, 1) = static_cast<float>(sky * tile + 0.9 * glow);
      map.rgb(x, y, 2) = static_cast<float>(sky * tile * (1 - 0.3 * d.z()) + 0.7 * glow);
    }
  }
  write_map(path, map, {}, {SampleType::kFloat, "zip"});
}

inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Runs with --json and expects success.
inline Json answer_of(std::vector<std::string> arguments) {
  arguments.push_back("--json");
  std::string line = "hdr";
  for (const std::string& a : arguments) line += " " + a;
  const CommandResult result = run_hdr(std::move(arguments));
  EXPECT_EQ(result.exit_code, 0) << line << "\n" << result.err;
  if (result.exit_code != 0) return Json::object();
  Json answer = Json::parse(result.out, nullptr, false);
  EXPECT_FALSE(answer.is_discarded()) << line << " printed something that is not one JSON object:\n" << result.out;
  return answer;
}

/// Expects exit code 1 and one line on stderr that has all of `words`; nothing on stdout.
inline void expect_refusal(std::vector<std::string> arguments, const std::vector<std::string>& words) {
  std::string line = "hdr";
  for (const std::string& a : arguments) line += " " + a;
  const CommandResult result = run_hdr(std::move(arguments));
  EXPECT_EQ(result.exit_code, 1) << line << "\n" << result.err;
  std::string errors;
  std::istringstream lines(result.err);
  for (std::string l; std::getline(lines, l);) {
    if (l.rfind("warning:", 0) != 0) errors += l + "\n";
  }
  EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 1) << line << "\nshould fail with one line, not\n"
                                                               << errors;
  for (const std::string& word : words) {
    EXPECT_NE(errors.find(word), std::string::npos) << line << "\nshould name '" << word << "' in\n" << errors;
  }
}

}  // namespace hdr::test
