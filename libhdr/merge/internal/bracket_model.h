#pragma once
// What a merge knows of the camera before it looks at the rows.
#include <optional>
#include <string>
#include <vector>

#include "libhdr/merge/internal/merge_model.h"

namespace hdr::internal {

/// What its registration leaves of a shot, before it is looked at.
enum class ShotUse {
  kEverywhere,
  kWhereOthersClip,  ///< stand_ins.h
  kNowhere
};
struct ShotRole {
  ShotUse use = ShotUse::kEverywhere;
  std::string reason;  ///< why not everywhere; else empty
};
std::vector<ShotRole> roles_of(const Alignment& alignment);
/// Those that are not merged everywhere, as other modules ask for them.
std::vector<bool> left_out(const std::vector<ShotRole>& roles);

struct BracketModels {
  MergeModel merge;
  std::optional<MergeModel> likelihood;  ///< with the shots' own noise; made where ghosts are looked for
};

BracketModels models_of(const Bracket& bracket, const Alignment& alignment, const std::vector<ShotRole>& roles,
                        const Response& response, const MergeOptions& options);

}  // namespace hdr::internal
