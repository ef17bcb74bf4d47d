#pragma once
// One shot as the merge reads it: the rows that a band of the map needs, as they pass by.
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/rows.h"
#include "libhdr/core/vec.h"
#include "libhdr/merge/internal/merge_model.h"
#include "libhdr/merge/internal/merge_row.h"
#include "libhdr/merge/internal/resample.h"

namespace hdr::internal {

struct RowRange {
  int first = 0, last = 0;
  bool operator==(const RowRange&) const = default;
};

/// Rows of a photograph that each band of `band_height` rows of the map needs, neighbours of cubic convolution
/// included; neither end ever falls. Bands that need none repeat the ends of their neighbours.
std::vector<RowRange> rows_of_bands(const Mat3& photo_from_ref, Size size, int band_height);

class Source {
 public:
  /// `photo` and `model` must outlive it. `exposure` in the map's unit.
  Source(const Photo& photo, const Mat3& ref_from_photo, const MergeModel& model, double exposure, int band_height);

  /// Makes the rows of a band ready. Bands in order.
  void advance(int band);

  float exposure() const { return exposure_; }
  bool registered() const { return registered_; }
  /// Row y of the map, within the band; a registered shot's codes, or nullptr.
  const void* codes(int y) const;
  /// A block of the band from a shot that is not registered; one of `rows` for each of the block's.
  void warp(const Block& block, Resampler::Patch& patch, std::vector<WarpedRow>& rows) const;
  /// The codes of the pixel nearest to pixel (x, y) of the map; false: outside the photograph.
  bool nearest(int x, int y, std::array<int, 3>& codes) const;

  /// Has the shot any code that is neither black nor clipped? Known from the rows that have passed, or else looked up
  /// in the whole shot: by then few shots are in doubt, and few pixels ask.
  bool usable() const;
  /// Why it carries nothing, once all rows have passed; empty when it is usable.
  std::string reason_to_skip() const;

 private:
  struct Found {
    bool usable = false, black = false, clipped = false;
  };
  void look_for_usable(const CodesView& codes, int first, int last, Found& found) const;

  const Photo& photo_;
  const MergeModel& model_;
  std::unique_ptr<PhotoRows> rows_;
  Size size_;
  bool registered_;
  Mat3 photo_from_ref_;
  Resampler resampler_;
  float exposure_;
  std::vector<RowRange> ranges_;
  CodesView view_;
  RowRange range_;  ///< rows in view_
  Found found_;
  mutable std::once_flag asked_;
  mutable bool usable_anywhere_ = false;
};

}  // namespace hdr::internal
