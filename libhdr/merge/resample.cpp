#include "libhdr/merge/internal/resample.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hdr::internal {
namespace {

/// Of a mean that lacks a clipped neighbour.
constexpr float kTrustBesideClipped = 1e-4f;
constexpr double kBorder_px = 16, kBorderShare = 0.05;
constexpr float kLeastTrust = 1e-3f;
/// Blocks are warped in parts whose pixels of the photograph stay in the cache.
constexpr int kPart = 64;
constexpr int kLargestPatch = 1 << 14;

/// Shares of the four neighbours at -1, 0, 1, 2 of a place t behind neighbour 0 [Keys81] eq. 15.
std::array<float, 4> cubic_shares(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return {0.5f * (2 * t2 - t3 - t), 0.5f * (3 * t3 - 5 * t2 + 2), 0.5f * (4 * t2 - 3 * t3 + t), 0.5f * (t3 - t2)};
}

float sum_of_squares(const std::array<float, 4>& s) {
  return s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + s[3] * s[3];
}

float weight_of_level(const ChannelModel& channel, float level) {
  const std::int32_t bin = (std::bit_cast<std::int32_t>(level) >> PrecisionTable::kShift) - PrecisionTable::kFirst;
  return channel.weight_of_level[static_cast<std::size_t>(std::clamp(bin, 0, PrecisionTable::kBins - 1))];
}

template <class Code>
void linearise(const View<const Code>& codes, int first_row, const MergeModel& model, Size size,
               Resampler::Patch& patch) {
  const auto samples = static_cast<std::size_t>(patch.width * patch.height);
  for (std::vector<float>& plane : patch.level) plane.resize(std::max(plane.size(), samples));
  const float* table[3] = {model.channel[0].level.data(), model.channel[1].level.data(), model.channel[2].level.data()};
  for (int y = 0; y < patch.height; ++y) {
    // Beyond the border the last pixels are repeated.
    const int row = std::clamp(std::clamp(patch.top + y, 0, size.height - 1) - first_row, 0, codes.height() - 1);
    const auto start = static_cast<std::size_t>(y * patch.width);
    for (int x = 0; x < patch.width; ++x) {
      const Code* p = codes.pixel(std::clamp(patch.left + x, 0, size.width - 1), row);
      for (std::size_t c = 0; c < 3; ++c) patch.level[c][start + static_cast<std::size_t>(x)] = table[c][p[c]];
    }
  }
}

}  // namespace

/// A place between the pixels of a patch.
struct Resampler::Taps {
  std::ptrdiff_t first = 0, stride = 0;  ///< of the 16, in the patch
  std::array<float, 4> x{}, y{};         ///< shares
  float u = 0, v = 0;
  float information = 1;  ///< 1 / sum of squared shares
};

bool Resampler::position(int x, int y, Vec2& out) const {
  const Vec3 p = photo_from_ref_ * Vec3(x, y, 1);
  out = {p.x() / p.z(), p.y() / p.z()};
  return p.z() > 0 && out.x() >= -0.5 && out.y() >= -0.5 && out.x() <= size_.width - 0.5 &&
         out.y() <= size_.height - 0.5;
}

float Resampler::border_trust(const Vec2& p) const {
  const double to_border = 0.5 + std::min({p.x(), p.y(), size_.width - 1 - p.x(), size_.height - 1 - p.y()});
  const double width = std::max(1.0, std::min(kBorder_px, kBorderShare * std::min(size_.width, size_.height)));
  const auto t = static_cast<float>(std::clamp(to_border / width, 0.0, 1.0));
  return std::max(kLeastTrust, t * t * (3 - 2 * t));
}

/// The pixels that a block needs; false: more than a patch holds, or behind the camera.
bool Resampler::patch_of(const Block& block, Patch& patch) const {
  // A projective map takes lines to lines: the corners bound the block.
  double left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY;
  for (const int x : {block.x0, block.x1 - 1}) {
    for (const int y : {block.y0, block.y1 - 1}) {
      const Vec3 p = photo_from_ref_ * Vec3(x, y, 1);
      if (!(p.z() > 0)) return false;
      left = std::min(left, p.x() / p.z());
      right = std::max(right, p.x() / p.z());
      top = std::min(top, p.y() / p.z());
      bottom = std::max(bottom, p.y() / p.z());
    }
  }
  const double last_x = size_.width - 0.5, last_y = size_.height - 0.5;
  patch.left = static_cast<int>(std::floor(std::clamp(left, -0.5, last_x))) - 1;
  patch.top = static_cast<int>(std::floor(std::clamp(top, -0.5, last_y))) - 1;
  patch.width = static_cast<int>(std::floor(std::clamp(right, -0.5, last_x))) + 3 - patch.left;
  patch.height = static_cast<int>(std::floor(std::clamp(bottom, -0.5, last_y))) + 3 - patch.top;
  return static_cast<std::int64_t>(patch.width) * patch.height <= kLargestPatch;
}

void Resampler::warp_pixel(const Patch& patch, const Vec2& p, std::size_t column, WarpedRow& out) const {
  const double left = std::floor(p.x()), top = std::floor(p.y());
  Taps taps;
  taps.stride = patch.width;
  taps.first = (static_cast<std::ptrdiff_t>(top) - 1 - patch.top) * taps.stride + static_cast<std::ptrdiff_t>(left) -
               1 - patch.left;
  taps.u = static_cast<float>(p.x() - left);
  taps.v = static_cast<float>(p.y() - top);
  taps.x = cubic_shares(taps.u);
  taps.y = cubic_shares(taps.v);
  taps.information = 1 / (sum_of_squares(taps.x) * sum_of_squares(taps.y));
  const float border = border_trust(p), u = taps.u, v = taps.v;
  const std::size_t nearest_x = u < 0.5f ? 0 : 1, nearest_y = v < 0.5f ? 0 : 1;
  const float share[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
  for (std::size_t c = 0; c < 3; ++c) {
    const ChannelModel& channel = model_.channel[c];
    const float* first = patch.level[c].data() + taps.first;
    const float* inner = first + taps.stride + 1;
    float sum[4], low[4], high[4];
    for (int k = 0; k < 4; ++k) {
      const float a = first[k], b = first[taps.stride + k], d = first[2 * taps.stride + k],
                  e = first[3 * taps.stride + k];
      sum[k] =
          ((taps.y[0] * a + taps.y[1] * b) + (taps.y[2] * d + taps.y[3] * e)) * taps.x[static_cast<std::size_t>(k)];
      low[k] = std::min(std::min(a, b), std::min(d, e));
      high[k] = std::max(std::max(a, b), std::max(d, e));
    }
    const float least = std::min(std::min(low[0], low[1]), std::min(low[2], low[3]));
    const float most = std::max(std::max(high[0], high[1]), std::max(high[2], high[3]));
    const float nearest =
        inner[static_cast<std::ptrdiff_t>(nearest_y) * taps.stride + static_cast<std::ptrdiff_t>(nearest_x)];
    const bool clipped = nearest >= channel.clip_bound;
    float level = std::clamp((sum[0] + sum[1]) + (sum[2] + sum[3]), least, most), trust = border;
    float information = taps.information;
    if (most >= channel.clip_bound || least <= channel.black_bound) {
      const float values[4] = {inner[0], inner[1], inner[taps.stride], inner[taps.stride + 1]};
      float total = 0, light = 0, squares = 0;
      for (int k = 0; k < 4; ++k) {
        if (values[k] >= channel.clip_bound) {
          if (share[k] > 0) trust = border * kTrustBesideClipped;
          continue;
        }
        total += share[k];
        light += share[k] * values[k];
        squares += share[k] * share[k];
      }
      // What is nearest is clipped, or black, or has a quarter of the shares or more.
      const bool bound = clipped || nearest <= channel.black_bound;
      level = bound ? nearest : light / total;
      information = bound ? 1 : total * total / squares;
      if (bound) trust = border;
    }
    if (model_.lossy) information = 1;  // a block's coefficients are wrong in many pixels at once
    out.closes[c][column] = model_.lossy && clipped;
    out.information[c][column] = information;
    if (!model_.hat) {
      out.level[c][column] = level;
      out.trust[c][column] = trust;
      continue;
    }
    const float weight = clipped || level <= channel.black_bound ? 0 : trust * weight_of_level(channel, level);
    out.weight[c][column] = weight;
    out.weight_light[c][column] = weight * (level * channel.saturation);
  }
}

void Resampler::warp_part(const CodesView& codes, int first_row, const Block& whole, const Block& part, Patch& patch,
                          std::vector<WarpedRow>& rows) const {
  const bool fits = patch_of(part, patch);
  const int width = part.x1 - part.x0, height = part.y1 - part.y0;
  if (!fits && width * height > 1) {  // strong perspective: in halves
    Block first = part, second = part;
    if (width >= height) {
      first.x1 = second.x0 = part.x0 + width / 2;
    } else {
      first.y1 = second.y0 = part.y0 + height / 2;
    }
    warp_part(codes, first_row, whole, first, patch, rows);
    warp_part(codes, first_row, whole, second, patch, rows);
    return;
  }
  const bool any_rows = std::visit([](const auto& view) { return !view.empty(); }, codes);
  if (fits && any_rows) std::visit([&](const auto& view) { linearise(view, first_row, model_, size_, patch); }, codes);
  for (int y = part.y0; y < part.y1; ++y) {
    WarpedRow& out = rows[static_cast<std::size_t>(y - whole.y0)];
    for (int x = part.x0; x < part.x1; ++x) {
      const auto column = static_cast<std::size_t>(x - whole.x0);
      Vec2 p;
      if (fits && any_rows && position(x, y, p)) {
        warp_pixel(patch, p, column, out);
      } else {
        out.set_outside(column);
      }
    }
  }
}

void Resampler::warp(const CodesView& codes, int first_row, const Block& block, Patch& patch,
                     std::vector<WarpedRow>& rows) const {
  for (int x = block.x0; x < block.x1; x += kPart) {
    const Block part{x, block.y0, std::min(x + kPart, block.x1), block.y1};
    warp_part(codes, first_row, block, part, patch, rows);
  }
}

}  // namespace hdr::internal
