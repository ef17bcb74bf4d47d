#include "libhdr/response/response_file.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/response/internal/fill_gaps.h"
#include "libhdr/response/internal/foreign_response.h"
#include "libhdr/response/internal/monotone.h"

namespace hdr {
namespace {

std::string lower_extension(const Path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

}  // namespace

std::string text_from_response(const Response& response, const Path& path, double rms_log_error,
                               const std::array<std::vector<double>, 3>& deviation) {
  const std::string extension = lower_extension(path);
  if (extension == ".m") return pfstools_from_response(response);
  if (extension == ".csv") return alicevision_from_response(response);
  return json_from_response(response, rms_log_error, deviation);
}

Response response_from_text(const std::string& text, const Path& path, int bits) {
  const std::string extension = lower_extension(path);
  if (extension == ".m") return response_from_pfstools(text, path.string());
  if (extension == ".csv") return response_from_alicevision(text, path.string(), bits);
  return response_from_json(text, path.string());
}

std::vector<double> g_from_exposures(std::vector<double> exposures, int bits, const std::string& where) {
  if (std::none_of(exposures.begin(), exposures.end(), [](double e) { return e > 0; })) {
    throw Error(where + ": no exposure is positive; such a response says nothing");
  }
  const bool black_known = exposures.front() > 0;
  exposures = fill_gaps(std::move(exposures));
  make_nondecreasing(exposures);
  Response codes;
  codes.bits = bits;
  const double rows_per_code = static_cast<double>(exposures.size() - 1) / (std::ldexp(1.0, bits) - 1);
  const auto at = [&](double code) {
    const double row = code * rows_per_code;
    const auto below = std::min(static_cast<std::size_t>(row), exposures.size() - 2);
    const double t = row - static_cast<double>(below);
    return std::lerp(exposures[below], exposures[below + 1], t);  // which does not fall where rows are equal
  };
  std::vector<double> g;
  for (int level = 0; level < response_levels(bits); ++level) g.push_back(at(codes.code_from_level(level)));
  // Half the exposure of code 1/2, which lies on the line from no light.
  if (!black_known) g[0] = 0.5 * at(0.5);
  if (!(g[0] > 0)) throw Error(where + ": exposures are too small to be told from 0; scale them");
  if (!(g.back() > g.front())) throw Error(where + ": the exposures are flat; such a response says nothing");
  const double middle = g[g.size() / 2];
  for (double& value : g) value = std::log(value / middle);
  return g;
}

}  // namespace hdr
