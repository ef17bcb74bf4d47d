#pragma once
// Others' response files, each a pair of functions.
#include <string>
#include <vector>

#include "libhdr/response/response.h"

namespace hdr {

std::string pfstools_from_response(const Response& response);
Response response_from_pfstools(const std::string& text, const std::string& source);

std::string alicevision_from_response(const Response& response);
Response response_from_alicevision(const std::string& text, const std::string& source, int bits);

/// A channel's g from exposures at codes spread evenly from 0 to 2^bits - 1; 0 is not known. Throws Error that begins
/// with `where` when nothing is known, or when they do not rise.
std::vector<double> g_from_exposures(std::vector<double> exposures, int bits, const std::string& where);

}  // namespace hdr
