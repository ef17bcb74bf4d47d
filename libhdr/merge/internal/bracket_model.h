#pragma once
// What a merge knows of the camera before it looks at the rows.
#include <optional>
#include <string>

#include "libhdr/merge/internal/merge_model.h"

namespace hdr::internal {

/// Why a shot is left out before it is looked at, or an empty string.
std::string reason_to_leave_out(const Alignment& alignment, std::size_t shot);

struct BracketModels {
  MergeModel merge;
  std::optional<MergeModel> likelihood;  ///< with the shots' own noise; made where ghosts are looked for
};

BracketModels models_of(const Bracket& bracket, const Alignment& alignment, const Response& response,
                        const MergeOptions& options);

}  // namespace hdr::internal
