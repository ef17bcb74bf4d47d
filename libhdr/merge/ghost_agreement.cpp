#include "libhdr/merge/internal/ghost_agreement.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "libhdr/core/median.h"

namespace hdr::internal {
namespace {

constexpr float kRelative = 0.02f;  ///< of the radiance, by each shot; by the hat's doubt more towards the ends
/// What cameras do to colours of which a channel is close to an end changes the others.
constexpr float kCrossTalk = 0.02f;
constexpr float kLeastHat = 0.06f;
constexpr float kLeastShift_px = 0.12f;   ///< registered shots are not registered perfectly
constexpr float kMostCorrection = 0.35f;  ///< ln
constexpr float kMostScale = 3;
constexpr float kMostMisfit = 0.35f;  ///< of a colour's distance from grey
constexpr std::size_t kFewest = 60;   ///< cells behind a median
/// Of the samples that would show that a colour has paled: more are the camera's doing. What moved seldom is paler and
/// as bright.
constexpr float kMostPaled = 0.1f;
constexpr float kPlain = 3;             ///< deviations
constexpr std::size_t kSample = 60000;  ///< cells that medians look at, about
/// Of the pixels of a lossy shot: a block's coefficients are wrong in many of them at once.
constexpr float kIndependent = 0.25f;

float square(float x) {
  return x * x;
}

}  // namespace

void CellShot::find_range(const CellGrid& grid) {
  const auto [width, height] = grid.cells;
  range.resize(picture.level.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {0, 0, 0};
      for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
          const auto cell = static_cast<std::size_t>(v * width + u);
          if (picture.flags[cell] & CellPicture::kOutside) continue;
          for (std::size_t c = 0; c < 3; ++c) {
            least[c] = std::min(least[c], picture.level[3 * cell + c]);
            most[c] = std::max(most[c], picture.level[3 * cell + c]);
          }
        }
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const float size = std::max(0.0f, most[c] - least[c]);
        range[3 * static_cast<std::size_t>(y * width + x) + c] =
            static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(size) >> 16);
      }
    }
  }
}

void CellShot::find_colours() {
  colour.resize(picture.flags.size());
  for (std::size_t cell = 0; cell < colour.size(); ++cell) {
    const bool clipped = picture.flags[cell] & (7 * CellPicture::kClipped);
    colour[cell] = ColourBins::bin_of(picture.level.data() + 3 * cell, clipped);
  }
}

float CellShot::range_of(std::size_t sample) const {
  return std::bit_cast<float>(static_cast<std::uint32_t>(range[sample]) << 16);
}

PairAgreement::PairAgreement(const CellGrid& grid, const MergeModel& model, const CellShot& a, const CellShot& b)
    : grid_(grid), model_(model), a_(a), b_(b) {
  pixels_ = static_cast<float>(grid.side * grid.side) * (model.lossy ? kIndependent : 1);
  registration_ = std::min(1.0f, std::sqrt(square(kLeastShift_px) + square(a.residual_px) + square(b.residual_px)));
  for (auto& channel : correction_) channel.fill(1);
  find_corrections();
  find_colours();
  // Scales are those of all cells: what pales and is excused would make small ones for what pales a little.
  const int pales_from = find_paling();
  find_scales_of_colours();
  find_scale();
  pales_from_ = pales_from;
}

/// Relative deviations of levels, by channel, for what is wrong with codes close to their ends.
std::array<float, 3> PairAgreement::doubt_at(const std::array<float, 3>& level) const {
  std::array<float, 3> hat, doubt;
  for (std::size_t c = 0; c < 3; ++c)
    hat[c] = std::max(kLeastHat, model_.channel[c].hat_of_level[PrecisionTable::bin_of(level[c])]);
  const float least = std::min({hat[0], hat[1], hat[2]});
  for (std::size_t c = 0; c < 3; ++c) doubt[c] = kRelative / hat[c] + kCrossTalk / least;
  return doubt;
}

/// Of `shot`, of which `other` expects something: a code is doubted where it is close to an end both as it is and as it
/// would have to be. The factor takes the other's levels to this shot's.
std::array<float, 3> PairAgreement::doubts(const CellShot& shot, const CellShot& other,
                                           const std::array<float, 3>& factor, std::size_t cell) const {
  if (!model_.distrusts_ends) return {kRelative, kRelative, kRelative};
  std::array<float, 3> seen, expected;
  for (std::size_t c = 0; c < 3; ++c) {
    seen[c] = shot.picture.level[3 * cell + c];
    if (shot.picture.flags[cell] & (CellPicture::kClipped << c)) seen[c] = 1;
    expected[c] = other.picture.level[3 * cell + c] * factor[c];
  }
  const std::array<float, 3> of_seen = doubt_at(seen), of_expected = doubt_at(expected);
  return {std::min(of_seen[0], of_expected[0]), std::min(of_seen[1], of_expected[1]),
          std::min(of_seen[2], of_expected[2])};
}

void PairAgreement::differences(std::size_t cell, Difference* out) const {
  for (std::size_t c = 0; c < 3; ++c) out[c] = {};
  const std::uint8_t flags_a = a_.picture.flags[cell], flags_b = b_.picture.flags[cell];
  if ((flags_a | flags_b) & CellPicture::kOutside) return;
  std::array<float, 3> a_per_b, b_per_a;
  for (std::size_t c = 0; c < 3; ++c) {
    a_per_b[c] = correction_of(cell, c) * a_.exposure / b_.exposure;
    b_per_a[c] = 1 / a_per_b[c];
  }
  const std::array<float, 3> doubt_a = doubts(a_, b_, a_per_b, cell), doubt_b = doubts(b_, a_, b_per_a, cell);
  const Light light = light_of(cell);
  const bool pales = light.brightness >= pales_from_;
  const float most_misfit = kMostMisfit * light.chroma * light.largest;
  for (std::size_t c = 0; c < 3; ++c) {
    const bool clipped_a = a_.clipped(cell, c), clipped_b = b_.clipped(cell, c);
    if (clipped_a && clipped_b) continue;
    const ChannelModel& channel = model_.channel[c];
    const std::size_t sample = 3 * cell + c;
    const ColourMisfit::Expected misfit = misfit_[c].expected(a_.colour[cell], b_.colour[cell]);
    Difference& d = out[c];
    d.value = light.a[c] - light.b[c] - std::clamp(misfit.offset * light.largest, -most_misfit, most_misfit);
    if (clipped_a) d.value = std::max(0.0f, d.value);  // a says: at least this
    if (clipped_b) d.value = std::min(0.0f, d.value);
    if (pales && d.value < 0) d.value = std::min(0.0f, d.value + light.paler[c]);  // b says: as bright, if paler
    const float per_a = 1 / a_.exposure, per_b = correction_of(cell, c) / b_.exposure;
    d.noise = (square(per_a) / channel.precision.at(a_.picture.level[sample]) +
               square(per_b) / channel.precision.at(b_.picture.level[sample])) /
              pixels_;
    const float range = std::min(a_.range_of(sample) * per_a, b_.range_of(sample) * per_b);
    // If both show one thing, it is closer to what the less doubtful one says.
    const float trust_a = 1 / square(doubt_a[c]), trust_b = 1 / square(doubt_b[c]);
    const float radiance = (trust_a * light.a[c] + trust_b * light.b[c]) / (trust_a + trust_b);
    d.shift = square(registration_ * range);
    d.other = (square(doubt_a[c]) + square(doubt_b[c])) * square(radiance) + d.shift;
    if (flags_a & (CellPicture::kBlack << c)) d.other += square(channel.black_bound * per_a);
    if (flags_b & (CellPicture::kBlack << c)) d.other += square(channel.black_bound * per_b);
    const float scale = misfit_[c].scale(a_.colour[cell], b_.colour[cell]);
    d.other += std::min((square(scale) - 1) * (d.noise + d.other) + misfit.variance * square(light.largest),
                        square(most_misfit));
  }
}

PairAgreement::Light PairAgreement::light_of(std::size_t cell) const {
  Light light;
  for (std::size_t c = 0; c < 3; ++c) {
    light.a[c] = a_.picture.level[3 * cell + c] / a_.exposure;
    light.b[c] = b_.picture.level[3 * cell + c] * correction_of(cell, c) / b_.exposure;
    // What both show; where the longer one is clipped, as the shorter one has it.
    light.largest = std::max(light.largest, b_.clipped(cell, c) ? light.a[c] : std::min(light.a[c], light.b[c]));
  }
  const float largest_of_a = std::max({light.a[0], light.a[1], light.a[2]});
  for (std::size_t c = 0; c < 3; ++c) light.paler[c] = largest_of_a - light.a[c];
  light.brightness = brightness_bin(largest_of_a * b_.exposure);
  const auto chroma = [](const std::array<float, 3>& rgb) {
    const auto [least, most] = std::minmax({rgb[0], rgb[1], rgb[2]});
    return most > 0 ? (most - least) / most : 0;
  };
  const bool hidden = b_.picture.flags[cell] & (7 * CellPicture::kClipped);
  light.chroma = hidden ? chroma(light.a) : std::min(chroma(light.a), chroma(light.b));
  return light;
}

template <class Visit>
void PairAgreement::for_some(const Visit& visit) const {
  const std::size_t count = a_.picture.flags.size(), step = std::max<std::size_t>(1, count / kSample);
  for (std::size_t cell = 0; cell < count; cell += step) {
    if (!((a_.picture.flags[cell] | b_.picture.flags[cell]) & CellPicture::kOutside)) visit(cell);
  }
}

void PairAgreement::find_corrections() {
  std::array<std::array<std::vector<float>, kOctaves>, 3> ratios;
  for_some([&](std::size_t cell) {
    if (a_.picture.flags[cell] | b_.picture.flags[cell]) return;
    for (std::size_t c = 0; c < 3; ++c) {
      const float level_a = a_.picture.level[3 * cell + c], level_b = b_.picture.level[3 * cell + c];
      if (!(level_a > 0 && level_b > 0)) continue;
      ratios[c][static_cast<std::size_t>(ColourBins::octave_of(level_a))].push_back(
          std::log(level_a / a_.exposure / (level_b / b_.exposure)));
    }
  });
  for (std::size_t c = 0; c < 3; ++c) {
    for (int octave = 0; octave < kOctaves; ++octave) {
      // Where b is clipped, those cells of b that are not are a choice: what moved, and nothing can be said.
      const bool seen = std::ldexp(1.0f, -octave) * b_.exposure < a_.exposure;
      std::vector<float>& of_octave = ratios[c][static_cast<std::size_t>(octave)];
      if (!seen || of_octave.size() < kFewest) continue;
      correction_[c][static_cast<std::size_t>(octave)] =
          std::exp(std::clamp(median_of(of_octave), -kMostCorrection, kMostCorrection));
    }
  }
}

void PairAgreement::find_colours() {
  std::array<std::vector<ColourSample>, 3> of_a, of_b;
  for_some([&](std::size_t cell) {
    const Light light = light_of(cell);
    if (!(light.largest > 0)) return;
    for (std::size_t c = 0; c < 3; ++c) {
      const bool clipped_a = a_.clipped(cell, c), clipped_b = b_.clipped(cell, c);
      const float value = clipped_a || clipped_b ? NAN : (light.a[c] - light.b[c]) / light.largest;
      if (!clipped_a) of_a[c].push_back({a_.colour[cell], value});
      if (!clipped_b) of_b[c].push_back({b_.colour[cell], value});
    }
  });
  for (std::size_t c = 0; c < 3; ++c) misfit_[c] = ColourMisfit(c, of_a[c], of_b[c]);
}

/// Quarter octaves of the level that a shot has to show, up to four times what it can.
int PairAgreement::brightness_bin(float level) {
  const float quarters = 4 * (2 - std::log2(std::max(level, 1e-6f)));
  return std::clamp(kBrightness - 1 - static_cast<int>(quarters), 0, kBrightness - 1);
}

int PairAgreement::find_paling() const {
  std::array<std::size_t, kBrightness> paled{}, all{};
  for_some([&](std::size_t cell) {
    const Light light = light_of(cell);
    Difference channels[3];
    differences(cell, channels);
    for (std::size_t c = 0; c < 3; ++c) {
      const float plain = kPlain * std::sqrt(channels[c].noise + channels[c].other);
      if (!(channels[c].noise > 0) || light.paler[c] < 2 * plain) continue;
      const auto bin = static_cast<std::size_t>(light.brightness);
      ++all[bin];
      paled[bin] += channels[c].value < -plain && channels[c].value > -light.paler[c] - plain;
    }
  });
  // The brighter, the paler: from the darkest bin on that shows it. What shots differ by in the dark is no fading.
  constexpr std::size_t kDarkest = 2;  // a third of white
  for (std::size_t bin = kDarkest; bin < kBrightness; ++bin) {
    const bool pales = static_cast<float>(paled[bin]) > kMostPaled * static_cast<float>(all[bin]);
    if (all[bin] >= kFewest && pales) return static_cast<int>(bin);
  }
  return kBrightness;
}

void PairAgreement::find_scales_of_colours() {
  std::array<std::vector<ColourSample>, 3> of_a, of_b;
  for_some([&](std::size_t cell) {
    Difference all[3];
    differences(cell, all);
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(all[c].noise > 0) || a_.clipped(cell, c) || b_.clipped(cell, c)) continue;
      const float size = std::abs(all[c].value) / std::sqrt(all[c].noise + all[c].other);
      of_a[c].push_back({a_.colour[cell], size});
      of_b[c].push_back({b_.colour[cell], size});
    }
  });
  for (std::size_t c = 0; c < 3; ++c) misfit_[c].find_scales(of_a[c], of_b[c]);
}

void PairAgreement::find_scale() {
  std::vector<float> sizes;
  for_some([&](std::size_t cell) {
    if (a_.picture.flags[cell] | b_.picture.flags[cell]) return;
    Difference all[3];
    differences(cell, all);
    for (const Difference& d : all) {
      if (d.noise > 0) sizes.push_back(std::abs(d.value) / std::sqrt(d.noise + d.other));
    }
  });
  constexpr float kMedianOfNormal = 0.67449f;
  if (sizes.size() >= kFewest) scale_ = std::clamp(median_of(sizes) / kMedianOfNormal, 1.0f, kMostScale);
}

/// Differences of three channels over rows of a box and one cell around it.
struct PairAgreement::Rows {
  int width = 0;
  std::vector<Difference> d;  ///< 3 a cell
};

void PairAgreement::raise(const CellBox& box, std::vector<std::uint8_t>& out) const {
  const int width = box.width() + 2, columns = grid_.cells.width, rows = grid_.cells.height;
  const auto row_of = [&](int y, Rows& row) {
    row.d.assign(3 * static_cast<std::size_t>(width), {});
    if (y < 0 || y >= rows) return;
    for (int k = 0; k < width; ++k) {
      const int x = box.x0 - 1 + k;
      if (x < 0 || x >= columns) continue;
      const auto cell = static_cast<std::size_t>(y * columns + x);
      differences(cell, row.d.data() + 3 * k);
    }
  };
  Rows window[3];
  row_of(box.y0 - 1, window[0]);
  row_of(box.y0, window[1]);
  const float inverse_scale = 1 / square(scale_);
  for (int y = box.y0; y < box.y1; ++y) {
    row_of(y + 1, window[2]);
    for (int x = 0; x < box.width(); ++x) {
      float most = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        Difference sum;
        float cells = 0;
        for (const Rows& row : window) {
          for (int k = 0; k < 3; ++k) {
            const Difference& d = row.d[3 * static_cast<std::size_t>(x + k) + c];
            if (!(d.noise > 0)) continue;
            sum.value += d.value;
            sum.noise += d.noise;
            sum.other += d.other;
            cells += 1;
          }
        }
        const Difference& own = window[1].d[3 * static_cast<std::size_t>(x + 1) + c];
        if (!(own.noise > 0)) continue;
        most = std::max(most, square(own.value) / (own.noise + own.other));
        if (cells > 1) most = std::max(most, square(sum.value) / (sum.noise + sum.other * cells));
      }
      const float size = std::sqrt(most * inverse_scale) * kUnit;
      std::uint8_t& value = out[static_cast<std::size_t>(y - box.y0) * static_cast<std::size_t>(box.width()) +
                                static_cast<std::size_t>(x)];
      value = std::max(value, static_cast<std::uint8_t>(std::min(255.0f, size)));
    }
    std::swap(window[0], window[1]);
    std::swap(window[1], window[2]);
  }
}

}  // namespace hdr::internal
