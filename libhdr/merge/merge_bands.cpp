#include "libhdr/merge/internal/merge_bands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/merge/internal/bounds.h"
#include "libhdr/merge/internal/bracket_model.h"
#include "libhdr/merge/internal/flat_field.h"
#include "libhdr/merge/internal/ghost_plan.h"
#include "libhdr/merge/internal/merge_row.h"
#include "libhdr/merge/internal/source.h"
#include "libhdr/merge/internal/stand_ins.h"
#include "libhdr/merge/internal/stops.h"

namespace hdr::internal {
namespace {

/// Rows of a band that one task merges, and, where shots are resampled, columns at a time: whole tiles, so that bytes
/// do not depend on them.
constexpr int kTaskHeight = 8;
constexpr int kSegment = 8 * kTile;

void check(const Bracket& bracket, const Alignment& alignment, const Response& response) {
  if (bracket.shots.empty()) throw Error("no shots: nothing to merge; name one or more photographs");
  HDR_ASSERT(alignment.frames.size() == bracket.shots.size());
  for (const Photo& photo : bracket.shots) {
    HDR_ASSERT(photo.size() == bracket.size());
    if (photo.bits != response.bits) {
      throw Error(photo.path.string() + ": has " + std::to_string(photo.bits) + "-bit codes, but the response is for " +
                  std::to_string(response.bits) + " bits; calibrate with photographs of this depth");
    }
    const double exposure = photo.relative_exposure();
    if (!(exposure > 0 && std::isfinite(exposure))) {
      throw Error(photo.path.string() + ": its exposure is not a positive number; pass --times");
    }
  }
}

std::vector<FrameGain> gains_of(const Bracket& bracket, const Alignment& alignment, const std::vector<ShotRole>& roles,
                                const Response& response, const MergeOptions& options) {
  if (!options.drift) return std::vector<FrameGain>(bracket.shots.size());
  return estimate_drift(bracket, alignment, response, left_out(roles));
}

/// What the rows of one task (the k-th of every band) have added up, and its memory.
struct Worker {
  std::int64_t clipped = 0, dark = 0;
  TileCount tiles;
  LuminanceHistogram histogram;
  MergeRowScratch scratch;
  Resampler::Patch patch;
  std::vector<std::vector<WarpedRow>> warped;  ///< by shot, the rows of a block
  /// By shot and row of the task, where it is not trusted everywhere; else empty.
  std::vector<std::array<std::vector<float>, kTaskHeight>> trust;
  std::vector<ShotRow> shots;
  std::vector<std::uint8_t> unmeasured;  ///< of the rows of a task
  std::vector<std::int64_t> stood_in;    ///< pixels, by stand-in
};

/// The merge of one bracket, band by band.
class BandMerger {
 public:
  BandMerger(const MergeModel& model, const GhostPlan& ghosts, std::vector<std::unique_ptr<Source>> sources,
             std::vector<std::unique_ptr<Source>> stand_ins, const FlatField& flat, Size size)
      : model_(model),
        ghosts_(ghosts),
        sources_(std::move(sources)),
        stand_ins_(model, std::move(stand_ins)),
        flat_(flat),
        size_(size),
        workers_((kBandHeight + kTaskHeight - 1) / kTaskHeight),
        any_warped_(std::any_of(sources_.begin(), sources_.end(), [](const auto& s) { return !s->registered(); })) {}

  void merge(int first, int last, const BandViews& views) {
    for_rows(static_cast<int>(sources_.size()), 1,
             [&](int shot, int) { sources_[static_cast<std::size_t>(shot)]->advance(first / kBandHeight); });
    stand_ins_.advance(first / kBandHeight);
    for_rows(last - first, kTaskHeight, [&](int from, int to) {
      Worker& worker = workers_[static_cast<std::size_t>(from / kTaskHeight)];
      merge_rows_of_task(first, from, to, views, worker);
      worker.histogram.add(views.rgb.rows(from, to));
    });
  }

  void summarize(MergeSummary& summary) const {
    LuminanceHistogram histogram;
    TileCount tiles;
    for (const Worker& worker : workers_) {
      summary.clipped += worker.clipped;
      summary.dark += worker.dark;
      tiles.all += worker.tiles.all;
      tiles.skipped += worker.tiles.skipped;
      histogram.join(worker.histogram);
    }
    summary.stops = histogram.stops();
    if (tiles.all > 0) summary.skipped_tiles = static_cast<double>(tiles.skipped) / static_cast<double>(tiles.all);
  }

  std::string reason_to_skip(std::size_t source) const { return sources_[source]->reason_to_skip(); }
  /// Pixels that a stand-in measured or bounded.
  std::int64_t stood_in(std::size_t k) const {
    std::int64_t pixels = 0;
    for (const Worker& worker : workers_) pixels += k < worker.stood_in.size() ? worker.stood_in[k] : 0;
    return pixels;
  }

 private:
  /// Rows from .. to - 1 of the band that starts with row `first` of the map.
  void merge_rows_of_task(int first, int from, int to, const BandViews& views, Worker& worker) {
    worker.stood_in.resize(stand_ins_.count());
    worker.unmeasured.resize(3 * static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(to - from));
    if (!ghosts_.empty()) find_trust(first + from, to - from, worker);
    const int step = any_warped_ ? kSegment : size_.width;
    for (int x0 = 0; x0 < size_.width; x0 += step) {
      const Block block{x0, first + from, std::min(size_.width, x0 + step), first + to};
      warp(block, worker);
      for (int y = from; y < to; ++y) merge_segment(block, first + y, task_of(y, x0, from, views, worker), worker);
    }
    for (int y = from; y < to; ++y) {
      const MergeRowTask row = task_of(y, 0, from, views, worker);
      finish_row(first + y, y - from, row, views.flags.empty() ? nullptr : views.flags.row(y), worker);
    }
  }

  /// Where row y of the band goes, from column x0 on.
  MergeRowTask task_of(int y, int x0, int from, const BandViews& views, Worker& worker) const {
    const auto samples = 3 * static_cast<std::ptrdiff_t>(size_.width);
    MergeRowTask task{&model_, nullptr, 0, size_.width};
    task.rgb = views.rgb.row(y) + 3 * x0;
    task.stddev = views.stddev.empty() ? nullptr : views.stddev.row(y) + 3 * x0;
    task.unmeasured = worker.unmeasured.data() + samples * (y - from) + 3 * x0;
    return task;
  }

  void find_trust(int y0, int rows, Worker& worker) const {
    worker.trust.resize(sources_.size());
    const auto padded = static_cast<std::size_t>((size_.width + kTile - 1) / kTile * kTile);
    for (std::size_t j = 0; j < sources_.size(); ++j) {
      for (int row = 0; row < rows; ++row) {
        std::vector<float>& trust = worker.trust[j][static_cast<std::size_t>(row)];
        trust.assign(padded, 1);
        if (!ghosts_.trust_row(j, y0 + row, trust.data())) trust.clear();
      }
    }
  }

  /// Of row `row` of the task, from its start; nullptr: full.
  const float* trust_of(std::size_t source, int row, const Worker& worker) const {
    if (ghosts_.empty()) return nullptr;
    const std::vector<float>& trust = worker.trust[source][static_cast<std::size_t>(row)];
    return trust.empty() ? nullptr : trust.data();
  }

  void warp(const Block& block, Worker& worker) const {
    worker.warped.resize(sources_.size());
    for (std::size_t j = 0; j < sources_.size(); ++j) {
      if (sources_[j]->registered()) continue;
      std::vector<WarpedRow>& rows = worker.warped[j];
      if (rows.empty()) rows.assign(kTaskHeight, WarpedRow(std::min(kSegment, size_.width)));
      sources_[j]->warp(block, worker.patch, rows);
    }
  }

  void merge_segment(const Block& block, int y, MergeRowTask task, Worker& worker) const {
    const std::ptrdiff_t code_bytes = model_.bits <= 8 ? 1 : 2;
    worker.shots.clear();
    for (std::size_t j = 0; j < sources_.size(); ++j) {
      ShotRow shot{nullptr, nullptr, sources_[j]->exposure()};
      if (sources_[j]->registered()) {
        shot.codes = static_cast<const char*>(sources_[j]->codes(y)) + 3 * code_bytes * block.x0;
      } else {
        shot.warped = &worker.warped[j][static_cast<std::size_t>(y - block.y0)];
      }
      if (const float* trust = trust_of(j, y - block.y0, worker)) shot.trust = trust + block.x0;
      worker.shots.push_back(shot);
    }
    task.shots = worker.shots.data();
    task.count = static_cast<int>(worker.shots.size());
    task.width = block.x1 - block.x0;
    const TileCount tiles = merge_row(task, worker.scratch);
    worker.tiles.all += tiles.all;
    worker.tiles.skipped += tiles.skipped;
  }

  /// Flat field, bounds and flags.
  void finish_row(int y, int task_row, const MergeRowTask& task, std::uint8_t* flags, Worker& worker) const {
    if (flags) std::fill_n(flags, size_.width, std::uint8_t{0});
    for (int x = 0; x < size_.width; ++x) {
      const std::uint8_t* unmeasured = task.unmeasured + 3 * x;
      const bool bounded = (unmeasured[0] | unmeasured[1] | unmeasured[2]) != 0;
      if (flat_.empty() && !bounded) continue;
      float* rgb = task.rgb + 3 * x;
      float* stddev = task.stddev ? task.stddev + 3 * x : nullptr;
      const std::array<float, 3> gain = flat_.gain(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        rgb[c] *= gain[c];
        if (stddev) stddev[c] *= gain[c];
      }
      if (!bounded) continue;
      std::array<ChannelEvidence, 3> evidence = gather_evidence(x, y, task_row, unmeasured, rgb, gain, worker);
      std::array<float, 3> deviation{};
      stand_ins_.testify(x, y, gain, evidence, deviation, worker.stood_in);
      const ResolvedPixel pixel = resolve_pixel(evidence);
      for (std::size_t c = 0; c < 3; ++c) {
        rgb[c] = pixel.rgb[c];
        if (stddev && unmeasured[c]) stddev[c] = evidence[c].measured >= 0 ? deviation[c] : rgb[c];
      }
      worker.clipped += pixel.clipped;
      worker.dark += pixel.dark;
      if (flags) {
        flags[x] = static_cast<std::uint8_t>((pixel.clipped ? kClippedFlag : 0) | (pixel.dark ? kDarkFlag : 0));
      }
    }
  }

  std::array<ChannelEvidence, 3> gather_evidence(int x, int y, int task_row, const std::uint8_t* unmeasured,
                                                 const float* rgb, const std::array<float, 3>& gain,
                                                 const Worker& worker) const {
    std::array<ChannelEvidence, 3> evidence;
    for (std::size_t c = 0; c < 3; ++c) {
      if (!unmeasured[c]) evidence[c].measured = rgb[c];
    }
    // From the longest down: the first black shot gives the least upper bound, the last clipped one the largest lower.
    for (std::size_t j = sources_.size(); j-- > 0;) {
      const Source& source = *sources_[j];
      const float* trust = trust_of(j, task_row, worker);
      std::array<int, 3> codes{};
      if ((trust && !(trust[x] > 0)) || !source.nearest(x, y, codes)) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        if (!unmeasured[c]) continue;
        const ChannelModel& channel = model_.channel[c];
        const float unit = gain[c] * channel.saturation / source.exposure();
        if (codes[c] >= model_.clipped_code) {
          evidence[c].at_least = std::max(evidence[c].at_least, unit);
        } else if (codes[c] <= channel.black_code && evidence[c].at_most < 0 && bounds_the_dark(source)) {
          evidence[c].at_most = unit * channel.dark;
        }
      }
    }
    return evidence;
  }

  /// A shot without light anywhere (a lens cap) says nothing of this pixel; unless no shot has any.
  bool bounds_the_dark(const Source& source) const {
    return source.usable() ||
           std::none_of(sources_.begin(), sources_.end(), [](const auto& other) { return other->usable(); });
  }

  const MergeModel& model_;
  const GhostPlan& ghosts_;
  std::vector<std::unique_ptr<Source>> sources_;
  StandIns stand_ins_;
  const FlatField& flat_;
  Size size_;
  std::vector<Worker> workers_;
  bool any_warped_;
};

/// The shots as their roles have it.
struct Cast {
  std::vector<std::unique_ptr<Source>> sources, stand_ins;
  std::vector<std::size_t> shots, stand_in_shots;  ///< of the bracket
};

Cast cast_of(const Bracket& bracket, const Alignment& alignment, const std::vector<ShotRole>& roles,
             const MergeModel& model, const std::vector<double>& exposures, double exposure_unit) {
  Cast cast;
  for (std::size_t j = 0; j < bracket.shots.size(); ++j) {
    if (roles[j].use == ShotUse::kNowhere) continue;
    const bool everywhere = roles[j].use == ShotUse::kEverywhere;
    (everywhere ? cast.sources : cast.stand_ins)
        .push_back(std::make_unique<Source>(bracket.shots[j], alignment.frames[j].ref_from_photo, model,
                                            exposures[j] / exposure_unit, kBandHeight));
    (everywhere ? cast.shots : cast.stand_in_shots).push_back(j);
  }
  return cast;
}

/// What became of each shot.
std::vector<MergedFrame> frames_of(const std::vector<ShotRole>& roles, const std::vector<std::string>& reasons_to_skip,
                                   const std::vector<std::int64_t>& stood_in, const std::vector<FrameGain>& gains) {
  std::vector<MergedFrame> frames(roles.size());
  bool any_used = false;
  for (std::size_t j = 0; j < frames.size(); ++j) {
    MergedFrame& frame = frames[j];
    frame.skipped = roles[j].use == ShotUse::kEverywhere ? reasons_to_skip[j] : roles[j].reason;
    if (roles[j].use == ShotUse::kWhereOthersClip && stood_in[j] > 0) {
      frame.limited = fmt::format("{}: used for {} pixels that clip in all others", roles[j].reason, stood_in[j]);
      frame.skipped.clear();
    }
    frame.used = frame.skipped.empty();
    any_used = any_used || frame.used;
  }
  // Every shot is black or clipped throughout: the bounds that they give are all there is.
  for (std::size_t j = 0; j < frames.size(); ++j) {
    if (!any_used) frames[j] = {true, "", "", {}};
    frames[j].gain = gains[j];
  }
  return frames;
}

}  // namespace

MergeSummary merge_bands(const Bracket& bracket, const Alignment& alignment, const Response& response,
                         const MergeOptions& options, const std::function<BandViews(int first, int last)>& views,
                         const std::function<void(int first, int last)>& done) {
  check(bracket, alignment, response);
  const Size size = bracket.size();
  const FlatField flat(options.flat, size);
  const std::vector<ShotRole> roles = roles_of(alignment);
  const BracketModels models = models_of(bracket, alignment, roles, response, options);
  MergeSummary summary;
  summary.exposure_unit =
      options.exposure_unit.value_or(bracket.shots[(bracket.shots.size() - 1) / 2].relative_exposure());
  const std::vector<FrameGain> gains = gains_of(bracket, alignment, roles, response, options);
  std::vector<double> exposures;
  for (std::size_t j = 0; j < gains.size(); ++j) {
    exposures.push_back(bracket.shots[j].relative_exposure() * gains[j].gain);
  }
  Cast cast = cast_of(bracket, alignment, roles, models.merge, exposures, summary.exposure_unit);
  GhostPlan ghosts;
  if (options.deghost) {
    ghosts = plan_ghosts(bracket, exposures, alignment, *models.likelihood, cast.shots);
    summary.ghosts = ghosts.summary(cast.shots);
  }
  BandMerger merger(models.merge, ghosts, std::move(cast.sources), std::move(cast.stand_ins), flat, size);
  for (int first = 0; first < size.height; first += kBandHeight) {
    const int last = std::min(size.height, first + kBandHeight);
    merger.merge(first, last, views(first, last));
    done(first, last);
  }
  merger.summarize(summary);
  std::vector<std::string> reasons_to_skip(roles.size());
  std::vector<std::int64_t> stood_in(roles.size());
  for (std::size_t k = 0; k < cast.shots.size(); ++k) reasons_to_skip[cast.shots[k]] = merger.reason_to_skip(k);
  for (std::size_t k = 0; k < cast.stand_in_shots.size(); ++k) stood_in[cast.stand_in_shots[k]] = merger.stood_in(k);
  summary.frames = frames_of(roles, reasons_to_skip, stood_in, gains);
  return summary;
}

}  // namespace hdr::internal
