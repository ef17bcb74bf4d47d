#pragma once
// Do the shots of a bracket show one scene? Without a response: whatever the curve and the exposures, a channel's codes
// rise with one another wherever neither shot is black or clipped, so ranks of registered pixels agree [Spearman04].
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/rows.h"

namespace hdr::internal {

/// A small picture of the green codes, at most 64 cells on its longer side.
struct SceneThumbnail {
  Size size;
  std::vector<float> code;  ///< mean of a cell, of 255; below 0 where a sample of it is close to black or clipped
  std::vector<float> rank;  ///< of the usable cells among themselves, -1 .. 1
};

/// Rows that pass by, looked at on their way: a thumbnail costs no second decoding.
class ThumbnailRows : public PhotoRows {
 public:
  ThumbnailRows(std::unique_ptr<PhotoRows> rows, int max_code);
  Size size() const override { return rows_->size(); }
  CodesView rows(int first, int last) override;
  /// Of the whole photograph, whichever rows were asked for; no row may be asked for afterwards.
  SceneThumbnail thumbnail();

 private:
  int sample_row() const;  ///< the next that is looked at
  void look_at(const CodesView& rows, int row);

  std::unique_ptr<PhotoRows> rows_;
  int max_code_, cell_, samples_, seen_ = 0;
  Size cells_;
  std::vector<double> sums_;
};

/// How two thumbnails of one size agree under the best of the shifts that a hand makes.
struct SceneAgreement {
  int cells = 0;           ///< usable in both
  double correlation = 0;  ///< of ranks
  double residual = 0;     ///< median distance from one rising curve, codes of 255
};
SceneAgreement scene_agreement(const SceneThumbnail& a, const SceneThumbnail& b);

/// `shots` rise in exposure; thumbnails[i] belongs to shots[i]. Names a shot of another scene, and one that it differs
/// from. Things that move, hands that shake and flat scenes pass: only a shot that contradicts each of its neighbours
/// that show what most shots show is a stranger.
std::optional<std::string> stranger_among(const std::vector<Photo>& shots, std::span<const SceneThumbnail> thumbnails);

}  // namespace hdr::internal
