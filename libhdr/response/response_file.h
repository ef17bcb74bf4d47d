#pragma once
// Response curves in files, ours and others': the extension decides.
//   .m     pfstools (pfshdrcalibrate): Octave matrices IR, IG, IB of rows `log10 exposure | code | exposure`, one for
//          each code of the photograph, and W, weights of the codes.
//   .csv   AliceVision: a line of names, then `index,red,green,blue,` with exposures, rows evenly spread over the
//   codes. other  JSON (response.h).
#include <array>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/response/response.h"

namespace hdr {

/// The text of a file named `path`. JSON has a place for the fit's rms and deviation, the others do not. `.csv` is
/// scaled so that the largest exposure is 1, and has 4096 rows for codes deeper than that.
std::string text_from_response(const Response& response, const Path& path, double rms_log_error = 0,
                               const std::array<std::vector<double>, 3>& deviation = {});

/// `text` as the extension of `path` says it is to be read. A `.csv` does not say of what depth its codes are: it is
/// taken as of `bits`, those of the photographs at hand; `.m` and JSON know theirs. In others' files an exposure of 0
/// means that it is not known: it is filled in from its neighbours (internal/fill_gaps.h), code 0 as Response has it;
/// and curves that fall here and there are pooled until they do not. Throws Error that names `path` and the line.
Response response_from_text(const std::string& text, const Path& path, int bits);

}  // namespace hdr
