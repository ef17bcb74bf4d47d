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

/// A position in the photograph, its four neighbours and their shares.
struct Sample {
  int x[2], y[2];
  float u, v;
};

/// Where pixel (x, y) of the map falls; false: outside. A pixel reaches half a pixel beyond its centre; NaN and points
/// behind the camera fail the test.
bool position(const Mat3& photo_from_ref, Size size, int x, int y, Vec2& out) {
  const Vec3 p = photo_from_ref * Vec3(x, y, 1);
  out = {p.x() / p.z(), p.y() / p.z()};
  return p.z() > 0 && out.x() >= -0.5 && out.y() >= -0.5 && out.x() <= size.width - 0.5 && out.y() <= size.height - 0.5;
}

Sample sample_at(const Vec2& p, Size size) {
  const double left = std::floor(p.x()), top = std::floor(p.y());
  Sample s;
  s.x[0] = std::max(0, static_cast<int>(left));
  s.x[1] = std::min(size.width - 1, static_cast<int>(left) + 1);
  s.y[0] = std::max(0, static_cast<int>(top));
  s.y[1] = std::min(size.height - 1, static_cast<int>(top) + 1);
  s.u = static_cast<float>(p.x() - left);
  s.v = static_cast<float>(p.y() - top);
  return s;
}

/// One channel of one pixel: light is mixed with light, and a clipped neighbour has no voice.
void mix(const MergeModel& model, std::size_t c, std::size_t x, const int (&codes)[4], const float (&share)[4],
         int nearest, WarpedRow& out) {
  const ChannelModel& channel = model.channel[c];
  const auto code = [&](int k) { return static_cast<std::size_t>(codes[k]); };
  out.closes[c][x] = codes[nearest] >= model.closing_code;
  float weight = 0, sum = 0;
  if (model.hat) {
    for (int k = 0; k < 4; ++k) {
      weight += share[k] * channel.weight[code(k)];
      sum += share[k] * channel.weight_light[code(k)];
    }
    out.weight[c][x] = weight;
    out.weight_light[c][x] = sum;
    return;
  }
  if (codes[nearest] >= model.clipped_code) {
    out.level[c][x] = channel.level[code(nearest)];
    return;
  }
  for (int k = 0; k < 4; ++k) {
    if (codes[k] >= model.clipped_code) continue;
    weight += share[k];
    sum += share[k] * channel.level[code(k)];
  }
  out.level[c][x] = sum / weight;  // the nearest has a quarter of a share or more
}

template <class Code>
void warp_row(const View<const Code>& view, int first_row, Size size, const Mat3& photo_from_ref,
              const MergeModel& model, int y, WarpedRow& out) {
  for (int x = 0; x < size.width; ++x) {
    const auto column = static_cast<std::size_t>(x);
    Vec2 p;
    if (!position(photo_from_ref, size, x, y, p)) {
      for (std::size_t c = 0; c < 3; ++c) {
        out.level[c][column] = -1;
        out.weight[c][column] = out.weight_light[c][column] = 0;
        out.closes[c][column] = 0;
      }
      continue;
    }
    const Sample s = sample_at(p, size);
    const float share[4] = {(1 - s.u) * (1 - s.v), s.u * (1 - s.v), (1 - s.u) * s.v, s.u * s.v};
    const Code* corner[4];
    for (int k = 0; k < 4; ++k) corner[k] = view.pixel(s.x[k % 2], s.y[k / 2] - first_row);
    const int nearest = (s.u < 0.5f ? 0 : 1) + (s.v < 0.5f ? 0 : 2);
    for (std::size_t c = 0; c < 3; ++c) {
      const int codes[4] = {corner[0][c], corner[1][c], corner[2][c], corner[3][c]};
      mix(model, c, column, codes, share, nearest, out);
    }
  }
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

void Source::warp(int y, WarpedRow& out) const {
  std::visit([&](const auto& view) { warp_row(view, range_.first, size_, photo_from_ref_, model_, y, out); }, view_);
}

bool Source::nearest(int x, int y, std::array<int, 3>& codes) const {
  Vec2 p(x, y);
  if (!registered_ && !position(photo_from_ref_, size_, x, y, p)) return false;
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
