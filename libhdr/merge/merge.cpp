#include "libhdr/merge/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/merge/internal/accumulate.h"
#include "libhdr/merge/internal/bounds.h"
#include "libhdr/merge/internal/stops.h"
#include "libhdr/merge/weight.h"

namespace hdr {
namespace {

/// One shot, ready to be summed.
struct Shot {
  const Photo* photo;
  bool registered;  ///< already on the reference grid
  bool summed;      ///< has usable codes
  Mat3 photo_from_ref;
  int clipped_code;               ///< from here up: any amount of light
  std::array<int, 3> black_code;  ///< up to here: no light
  ContributionTable table;
  std::array<std::vector<float>, 3> radiance;  ///< exp(g(Z)) H_unit / H
};

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

Shot prepare(const Photo& photo, const Mat3& ref_from_photo, const Response& response, WeightKind kind,
             double exposure_unit) {
  Shot shot;
  shot.photo = &photo;
  shot.registered = ref_from_photo.isIdentity(0);
  shot.photo_from_ref = ref_from_photo.inverse();
  shot.clipped_code = first_clipped_code(photo.bits, photo.lossy);
  const double exposure = photo.relative_exposure() / exposure_unit;
  for (int channel = 0; channel < 3; ++channel) {
    const auto c = static_cast<std::size_t>(channel);
    shot.black_code[c] = response.black_code(channel);
    const std::vector<float> weights = code_weights(response, channel, photo.lossy, kind);
    const std::vector<float> exposures = response.exposure_table(channel);
    for (std::size_t code = 0; code < exposures.size(); ++code) {
      const auto radiance = static_cast<float>(exposures[code] / exposure);
      shot.radiance[c].push_back(radiance);
      // Shots that see one radiance E have exp(g) = E H: this is exp(g)^2 / variance, in the mean of logs (weight.h).
      const auto weight = static_cast<float>(weights[code] * exposure);
      shot.table[c].push_back({radiance * weight, weight});
    }
  }
  return shot;
}

/// Why a shot carries nothing, or an empty string: does any sample have a usable code?
std::string reason_to_skip(const Shot& shot) {
  struct Found {
    bool usable = false, black = false, clipped = false;
  };
  const Found found = std::visit(
      [&](const auto& image) {
        return reduce_rows(
            image.height(), 64, Found{},
            [&](int first, int last) {
              Found part;
              for (int y = first; y < last && !part.usable; ++y) {
                const auto* row = image.row(y);
                for (std::size_t k = 0; k < image.row_samples(); ++k) {
                  const int code = row[k];
                  HDR_ASSERT(code <= shot.photo->max_code());
                  const bool black = code <= shot.black_code[k % 3], clipped = code >= shot.clipped_code;
                  part.black |= black;
                  part.clipped |= clipped;
                  part.usable |= !black && !clipped;
                }
              }
              return part;
            },
            [](Found& total, const Found& part) {
              total.usable |= part.usable;
              total.black |= part.black;
              total.clipped |= part.clipped;
            });
      },
      shot.photo->codes);
  if (found.usable) return "";
  if (!found.clipped) return "all black";
  return found.black ? "all black or clipped" : "all clipped";
}

/// Exact evidence on a pixel, from the nearest pixel of each shot.
std::array<ChannelEvidence, 3> gather_evidence(const std::vector<Shot>& shots, int x, int y) {
  std::array<ChannelEvidence, 3> evidence;
  for (const Shot& shot : shots) {
    const Vec2 p = shot.registered ? Vec2(x, y) : (shot.photo_from_ref * Vec3(x, y, 1)).hnormalized().eval();
    if (!(p.x() >= -0.5 && p.y() >= -0.5 && p.x() <= shot.photo->width() - 0.5 &&
          p.y() <= shot.photo->height() - 0.5)) {
      continue;
    }
    const int u = std::min(static_cast<int>(std::lround(std::max(0.0, p.x()))), shot.photo->width() - 1);
    const int v = std::min(static_cast<int>(std::lround(std::max(0.0, p.y()))), shot.photo->height() - 1);
    for (std::size_t c = 0; c < 3; ++c) {
      const int code =
          std::visit([&](const auto& image) -> int { return image(u, v, static_cast<int>(c)); }, shot.photo->codes);
      ChannelEvidence& e = evidence[c];
      if (code >= shot.clipped_code) {
        e.at_least = std::max(e.at_least, shot.radiance[c].back());
      } else if (shot.summed && code <= shot.black_code[c]) {
        const float black = shot.radiance[c].front();
        e.at_most = e.at_most < 0 ? black : std::min(e.at_most, black);
      }
    }
  }
  return evidence;
}

struct Counts {
  std::int64_t clipped = 0, dark = 0;
};

void accumulate(const std::vector<Shot>& shots, int y, RowSums& sums) {
  sums.clear();
  for (const Shot& shot : shots) {
    // Only lossy codes contradict a shorter shot that clips; in others it is a thing that moved, or a painted border.
    const int closing_code = shot.photo->lossy ? shot.clipped_code : shot.photo->max_code() + 1;
    if (shot.registered) {
      accumulate_row(shot.photo->codes, shot.table, closing_code, y, sums);
    } else {
      accumulate_warped_row(shot.photo->codes, shot.table, closing_code, shot.photo_from_ref, y, sums);
    }
  }
}

/// Row y of the map: means where there are weights, bounds elsewhere.
Counts merge_row(const std::vector<Shot>& shots, int y, RowSums& sums, float* out) {
  accumulate(shots, y, sums);
  Counts counts;
  for (std::size_t k = 0; k < sums.weight.size(); k += 3) {
    bool measured = true;
    for (std::size_t c = k; c < k + 3; ++c) {
      measured = measured && sums.weight[c] > 0;
      out[c] = sums.weighted_radiance[c] / std::max(sums.weight[c], std::numeric_limits<float>::min());
    }
    if (measured) continue;
    std::array<ChannelEvidence, 3> evidence = gather_evidence(shots, static_cast<int>(k / 3), y);
    for (std::size_t c = 0; c < 3; ++c) {
      if (sums.weight[k + c] > 0) evidence[c].measured = out[k + c];
    }
    const ResolvedPixel pixel = resolve_pixel(evidence);
    std::copy(pixel.rgb.begin(), pixel.rgb.end(), out + k);
    counts.clipped += pixel.clipped;
    counts.dark += pixel.dark;
  }
  return counts;
}

/// The shots to be merged; fills in merged.frames. A shot without a usable code is not summed, but what it clips or
/// leaves black still bounds the light.
std::vector<Shot> prepare_all(const Bracket& bracket, const Alignment& alignment, const Response& response,
                              WeightKind kind, Merged& merged) {
  std::vector<Shot> shots;
  for (std::size_t j = 0; j < bracket.shots.size(); ++j) {
    MergedFrame& frame = merged.frames[j];
    const double residual_px = alignment.frames[j].residual_px;
    // Left out, a longer shot costs some noise in the shadows; a shorter one may hold the only measure of a sun.
    constexpr double kWorstRegistration_px = 1;
    if (static_cast<int>(j) > alignment.reference && residual_px > kWorstRegistration_px) {
      frame.skipped = fmt::format("registered within {:.1f} px only", residual_px);
      continue;
    }
    Shot shot = prepare(bracket.shots[j], alignment.frames[j].ref_from_photo, response, kind, merged.exposure_unit);
    frame.skipped = reason_to_skip(shot);
    frame.used = shot.summed = frame.skipped.empty();
    shots.push_back(std::move(shot));
  }
  if (std::any_of(shots.begin(), shots.end(), [](const Shot& shot) { return shot.summed; })) return shots;
  // Every shot is black or clipped throughout: the bounds that they give are all there is.
  for (Shot& shot : shots) shot.summed = true;
  for (MergedFrame& frame : merged.frames) frame = {true, ""};
  return shots;
}

}  // namespace

Merged merge(const Bracket& bracket, const Alignment& alignment, const Response& response,
             const MergeOptions& options) {
  check(bracket, alignment, response);
  Merged merged;
  merged.frames.resize(bracket.shots.size());
  merged.exposure_unit = bracket.shots[(bracket.shots.size() - 1) / 2].relative_exposure();
  const std::vector<Shot> shots = prepare_all(bracket, alignment, response, options.weight, merged);

  const Size size = bracket.size();
  merged.map.rgb = Image<float>(size, 3);
  const Counts counts = reduce_rows(
      size.height, 16, Counts{},
      [&](int first, int last) {
        RowSums sums(static_cast<std::size_t>(size.width) * 3);
        Counts part;
        for (int y = first; y < last; ++y) {
          const Counts row = merge_row(shots, y, sums, merged.map.rgb.row(y));
          part.clipped += row.clipped;
          part.dark += row.dark;
        }
        return part;
      },
      [](Counts& total, const Counts& part) {
        total.clipped += part.clipped;
        total.dark += part.dark;
      });
  merged.clipped = counts.clipped;
  merged.dark = counts.dark;
  merged.stops = stops_of_luminance(merged.map.rgb);
  return merged;
}

}  // namespace hdr
