#include "tests/bench/merged_rows.h"

#include "libhdr/core/parallel.h"
#include "libhdr/merge/internal/bracket_model.h"
#include "libhdr/merge/internal/merge_row.h"

namespace hdr::bench {

using internal::MergeRowTask;
using internal::ShotRow;
using internal::TileCount;

MergedRows merged_rows(const Bracket& bracket, const Response& response, WeightKind weight, RowKernel kernel) {
  MergeOptions options;
  options.weight = weight;
  const Alignment still = no_alignment(bracket);
  const internal::MergeModel model =
      internal::models_of(bracket, still, internal::roles_of(still), response, options).merge;
  const double unit = bracket.shots[(bracket.shots.size() - 1) / 2].relative_exposure();
  const Size size = bracket.size();
  MergedRows merged{Image<float>(size, 3), 0};
  const TileCount tiles = reduce_rows(
      size.height, 16, TileCount{},
      [&](int first, int last) {
        TileCount count;
        internal::MergeRowScratch scratch;
        std::vector<std::uint8_t> unmeasured(3 * static_cast<std::size_t>(size.width));
        std::vector<ShotRow> shots(bracket.shots.size());
        for (int y = first; y < last; ++y) {
          for (std::size_t k = 0; k < shots.size(); ++k) {
            const Photo& photo = bracket.shots[k];
            shots[k].codes = std::visit([y](const auto& codes) -> const void* { return codes.row(y); }, photo.codes);
            shots[k].exposure = static_cast<float>(photo.relative_exposure() / unit);
          }
          MergeRowTask task{&model, shots.data(), static_cast<int>(shots.size()), size.width};
          task.skip_tiles = kernel != RowKernel::kEveryTile;
          task.rgb = merged.rgb.row(y);
          task.stddev = nullptr;
          task.unmeasured = unmeasured.data();
          if (kernel == RowKernel::kReference) {
            internal::reference::merge_row(task);
            continue;
          }
          const TileCount row = internal::merge_row(task, scratch);
          count.all += row.all;
          count.skipped += row.skipped;
        }
        return count;
      },
      [](TileCount& total, const TileCount& part) {
        total.all += part.all;
        total.skipped += part.skipped;
      });
  if (tiles.all > 0) merged.skipped_share = static_cast<double>(tiles.skipped) / static_cast<double>(tiles.all);
  return merged;
}

}  // namespace hdr::bench
