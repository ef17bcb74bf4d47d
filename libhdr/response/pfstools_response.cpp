// pfstools' response files. pfshdrcalibrate writes text that Octave loads:
//   # Camera response curve, channel IR
//   # data layout: log10(response) | camera output | response
//   # name: IR
//   # type: matrix
//   # rows: 256
//   # columns: 3
//    -3.010300e+00    1 9.765625e-04
// and so on for IG and IB, then the weights of the codes, `weight | camera output`, as matrix W.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <optional>
#include <sstream>

#include "libhdr/core/error.h"
#include "libhdr/response/internal/foreign_response.h"

namespace hdr {
namespace {

constexpr const char* kNames[3] = {"IR", "IG", "IB"};

/// The text after `key` in a line such as "# rows: 256".
std::optional<std::string> value_of(const std::string& line, const std::string& key) {
  const std::string head = "# " + key + ": ";
  if (line.rfind(head, 0) != 0) return std::nullopt;
  std::string value = line.substr(head.size());
  while (!value.empty() && (value.back() == '\r' || value.back() == ' ')) value.pop_back();
  return value;
}

int whole_number(const std::string& text, const std::string& where) {
  std::istringstream stream(text);
  int number = 0;
  if (!(stream >> number) || number < 1 || number > 1 << 16) {
    throw Error(where + ": '" + text + "' is not a number of rows or columns");
  }
  return number;
}

/// The depth of codes of which there are `rows`.
int bits_from_rows(int rows, const std::string& where) {
  for (int bits = 8; bits <= 16; ++bits) {
    if (rows == 1 << bits) return bits;
  }
  throw Error(fmt::format("{}: {} rows; a response of 8 to 16 bits has one for each code, 256 to 65536", where, rows));
}

}  // namespace

std::string pfstools_from_response(const Response& response) {
  std::string text;
  const int codes = 1 << response.bits;
  for (int c = 0; c < 3; ++c) {
    text += fmt::format(
        "# Camera response curve, channel {0}\n# data layout: log10(response) | camera output | response\n# name: {0}\n"
        "# type: matrix\n# rows: {1}\n# columns: 3\n",
        kNames[c], codes);
    for (int code = 0; code < codes; ++code) {
      // Code 0 as it stands, not through exposure(): Response::exposure(0) is exp(g(0)).
      const double exposure = response.exposure(c, code);
      text += fmt::format(" {:.9e} {:4d} {:.9e}\n", std::log10(exposure), code, exposure);
    }
    text += '\n';
  }
  // pfstools' own readers ask for weights, too: the Gaussian of [Robertson03].
  text += fmt::format(
      "# Weighting function\n# data layout: weight | camera output\n# name: W\n# type: matrix\n# rows: {}\n# columns: "
      "2\n",
      codes);
  for (int code = 0; code < codes; ++code) {
    const double z = 2.0 * code / (codes - 1) - 1;
    text += fmt::format(" {:.6e} {:4d}\n", (std::exp(-4 * z * z) - std::exp(-4)) / (1 - std::exp(-4)), code);
  }
  return text + '\n';
}

Response response_from_pfstools(const std::string& text, const std::string& source) {
  std::map<std::string, std::vector<double>> matrices;
  std::istringstream lines(text);
  std::string name;
  int rows = 0, number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string where = fmt::format("{}:{}", source, ++number);
    if (const auto value = value_of(line, "name")) name = *value;
    if (const auto value = value_of(line, "rows")) rows = whole_number(*value, where);
    const auto columns = value_of(line, "columns");
    if (!columns || name == "W") continue;
    if (whole_number(*columns, where) != 3) {
      throw Error(where +
                  ": a response has 3 columns, log10 exposure, code and exposure; make one with pfshdrcalibrate");
    }
    std::vector<double>& exposures = matrices[name];
    exposures.assign(static_cast<std::size_t>(rows), 0);
    for (int row = 0; row < rows; ++row) {
      std::getline(lines, line);
      std::istringstream numbers(line);
      double log10 = 0, code = -1, exposure = 0;
      if (!lines || !(numbers >> log10 >> code >> exposure) || !(code >= 0 && code < rows) || !(exposure >= 0)) {
        throw Error(
            fmt::format("{}:{}: not a row `log10 exposure, code, exposure` of {} codes", source, ++number, rows));
      }
      ++number;
      exposures[static_cast<std::size_t>(code)] = exposure;
    }
  }
  Response response;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto matrix = matrices.find(kNames[c]);
    if (matrix == matrices.end()) throw Error(source + ": no matrix " + kNames[c] + "; not a response of pfstools");
    const std::string where = source + ": " + kNames[c];
    const int bits = bits_from_rows(static_cast<int>(matrix->second.size()), where);
    if (c > 0 && bits != response.bits) throw Error(where + ": has another number of rows than IR");
    response.bits = bits;
    response.g[c] = g_from_exposures(matrix->second, bits, where);
  }
  return response;
}

}  // namespace hdr
