// AliceVision's response files: `NAME,Red,Green,Blue,` and then, row by row, the index and the exposures of the three
// channels. Row k of n stands for code k / (n - 1) of the largest.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "libhdr/core/error.h"
#include "libhdr/response/internal/foreign_response.h"

namespace hdr {
namespace {

constexpr const char* kNames[3] = {"red", "green", "blue"};
constexpr int kMostRows = 4096;

/// The fields of a line, and none after the last comma.
std::vector<std::string> fields(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

double exposure_from_field(const std::string& field, const std::string& where) {
  std::istringstream stream(field);
  double value = 0;
  if (!(stream >> value) || !(stream >> std::ws).eof() || !(value >= 0 && std::isfinite(value))) {
    throw Error(where + ": '" + field + "' is not an exposure, a number from 0 on");
  }
  return value;
}

}  // namespace

std::string alicevision_from_response(const Response& response) {
  const int codes = 1 << response.bits, rows = std::min(codes, kMostRows);
  double largest = 0;
  for (int c = 0; c < 3; ++c) largest = std::max(largest, response.exposure(c, codes - 1));
  std::string text = "response,Red,Green,Blue,\n";
  for (int row = 0; row < rows; ++row) {
    const double code = static_cast<double>(row) * (codes - 1) / (rows - 1);
    text += fmt::format("{},", row);
    for (int c = 0; c < 3; ++c) text += fmt::format("{:.9e},", response.exposure(c, code) / largest);
    text += '\n';
  }
  return text;
}

Response response_from_alicevision(const std::string& text, const std::string& source, int bits) {
  std::array<std::vector<double>, 3> exposures;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string where = fmt::format("{}:{}", source, ++number);
    const std::vector<std::string> row = fields(line);
    if (number == 1 || row.empty()) continue;  // the names; the end
    if (row.size() != 4) throw Error(where + ": not a row `index,red,green,blue,` of a response");
    for (std::size_t c = 0; c < 3; ++c) exposures[c].push_back(exposure_from_field(row[c + 1], where));
  }
  if (exposures[0].size() < 64) {
    throw Error(
        fmt::format("{}: {} rows; a response has 64 or more after a line of names", source, exposures[0].size()));
  }
  Response response;
  response.bits = bits;
  for (std::size_t c = 0; c < 3; ++c) {
    response.g[c] = g_from_exposures(std::move(exposures[c]), bits, source + ": " + kNames[c]);
  }
  return response;
}

}  // namespace hdr
