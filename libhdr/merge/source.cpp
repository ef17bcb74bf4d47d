#include "libhdr/merge/internal/source.h"

#include <algorithm>
#include <cmath>

namespace hdr::internal {
namespace {

/// The rows that rows y0 .. y1 - 1 of the map need, not yet in order with those of other bands; empty: none.
RowRange rows_needed(const Mat3& photo_from_ref, Size size, int y0, int y1) {
  // A projective map takes lines to lines, so the corners bound a band, as long as it does not reach behind the camera.
  double top = INFINITY, bottom = -INFINITY;
  for (const double x : {-0.5, size.width - 0.5}) {
    for (const int y : {y0, y1 - 1}) {
      const Vec3 p = photo_from_ref * Vec3(x, y, 1);
      if (!(p.z() > 0)) return {0, size.height};
      top = std::min(top, p.y() / p.z());
      bottom = std::max(bottom, p.y() / p.z());
    }
  }
  if (!(bottom >= -0.5 && top <= size.height - 0.5)) return {};
  const double first = std::clamp(std::floor(top) - 1, 0.0, size.height - 1.0);
  const double last = std::clamp(std::floor(bottom) + 3, 1.0, static_cast<double>(size.height));
  return {static_cast<int>(first), static_cast<int>(last)};
}

}  // namespace

std::vector<RowRange> rows_of_bands(const Mat3& photo_from_ref, Size size, int band_height) {
  std::vector<RowRange> ranges;
  for (int y = 0; y < size.height; y += band_height) {
    ranges.push_back(photo_from_ref.isIdentity(0)
                         ? RowRange{y, std::min(size.height, y + band_height)}
                         : rows_needed(photo_from_ref, size, y, std::min(size.height, y + band_height)));
  }
  // A row is kept while a later band needs it.
  int earliest = size.height;
  for (auto range = ranges.rbegin(); range != ranges.rend(); ++range) {
    if (range->first < range->last) earliest = std::min(earliest, range->first);
    range->first = earliest;
  }
  int latest = 0;
  for (RowRange& range : ranges) {
    latest = range.last = std::max({latest, range.last, 0});
    range.first = std::min(range.first, range.last);
  }
  return ranges;
}

Source::Source(const Photo& photo, const Mat3& ref_from_photo, const MergeModel& model, double exposure,
               int band_height)
    : photo_(photo),
      model_(model),
      rows_(rows_of(photo)),
      size_(photo.size()),
      registered_(ref_from_photo.isIdentity(0)),
      photo_from_ref_(ref_from_photo.inverse()),
      resampler_(model, photo_from_ref_, size_),
      exposure_(static_cast<float>(exposure)),
      ranges_(rows_of_bands(registered_ ? Mat3::Identity() : photo_from_ref_, size_, band_height)) {}

void Source::advance(int band) {
  const RowRange next = ranges_[static_cast<std::size_t>(band)];
  if (next.first == next.last) return;
  view_ = rows_->rows(next.first, next.last);
  const int seen = range_.last;
  range_ = next;
  if (!found_.usable) look_for_usable(view_, std::max(seen, next.first) - next.first, next.last - next.first, found_);
}

const void* Source::codes(int y) const {
  if (!registered_) return nullptr;
  return std::visit([&](const auto& view) -> const void* { return view.row(y - range_.first); }, view_);
}

void Source::warp(const Block& block, Resampler::Patch& patch, std::vector<WarpedRow>& rows) const {
  resampler_.warp(view_, range_.first, block, patch, rows);
}

bool Source::nearest(int x, int y, std::array<int, 3>& codes) const {
  Vec2 p(x, y);
  if (!registered_ && !resampler_.position(x, y, p)) return false;
  const int u = std::clamp(static_cast<int>(std::lround(p.x())), 0, size_.width - 1);
  const int v = std::clamp(static_cast<int>(std::lround(p.y())), 0, size_.height - 1);
  std::visit([&](const auto& view) { std::copy_n(view.pixel(u, v - range_.first), 3, codes.begin()); }, view_);
  return true;
}

void Source::look_for_usable(const CodesView& codes, int first, int last, Found& found) const {
  const int black[3] = {model_.channel[0].black_code, model_.channel[1].black_code, model_.channel[2].black_code};
  const int clipped = model_.clipped_code;
  std::visit(
      [&](const auto& view) {
        for (int y = first; y < last && !found.usable; ++y) {
          const auto* row = view.row(y);
          unsigned any_usable = 0, any_black = 0, any_clipped = 0;
          for (int k = 0; k < 3 * view.width(); k += 3) {
            for (int c = 0; c < 3; ++c) {
              const unsigned is_black = row[k + c] <= black[c], is_clipped = row[k + c] >= clipped;
              any_black |= is_black;
              any_clipped |= is_clipped;
              any_usable |= 1u ^ (is_black | is_clipped);
            }
          }
          found.usable |= any_usable != 0;
          found.black |= any_black != 0;
          found.clipped |= any_clipped != 0;
        }
      },
      codes);
}

bool Source::usable() const {
  if (found_.usable) return true;
  std::call_once(asked_, [&] {
    constexpr int kRows = 64;
    const std::unique_ptr<PhotoRows> rows = rows_of(photo_);
    Found found;
    for (int first = 0; first < size_.height && !found.usable; first += kRows) {
      const int last = std::min(size_.height, first + kRows);
      look_for_usable(rows->rows(first, last), 0, last - first, found);
    }
    usable_anywhere_ = found.usable;
  });
  return usable_anywhere_;
}

std::string Source::reason_to_skip() const {
  if (found_.usable) return "";
  if (!found_.clipped) return "all black";
  return found_.black ? "all black or clipped" : "all clipped";
}

}  // namespace hdr::internal
