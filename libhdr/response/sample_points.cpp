// Which pixels calibration looks at.
#include <algorithm>
#include <cmath>
#include <map>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/rows.h"
#include "libhdr/response/internal/observations.h"

namespace hdr {
namespace {

constexpr int kCandidates = 20000;  ///< places looked at
constexpr int kBins = 64;           ///< of brightness, from which points are drawn equally
/// Of a window's range of codes, between its mean and white. Up to .6 the means of noisy windows at code 240 are still
/// a code low, and more than 1 leaves few of them.
constexpr double kHeadroom = 0.8;

constexpr int kRegions = 4;  ///< the picture's 4x4 regions share a bin

struct Candidate {
  double x, y;  ///< on the reference grid
};

/// One candidate in one channel of one shot.
struct WindowCodes {
  float mean = NAN;  ///< NaN outside the frame
  float smallest = 0, largest = 0;
};

/// A jittered grid: a place in each cell, so that no pattern of the scene (or of JPEG's blocks) is met in step.
std::vector<Candidate> jittered_grid(Size size) {
  const double step = std::max(1.0, std::sqrt(static_cast<double>(size.width) * size.height / kCandidates));
  std::vector<Candidate> grid;
  std::uint64_t cell = 0;
  for (double y = 0; y < size.height; y += step) {
    for (double x = 0; x < size.width; x += step) {
      Random random(0x5eed, cell++);
      grid.push_back({std::min(x + step * random.uniform(), size.width - 1e-6),
                      std::min(y + step * random.uniform(), size.height - 1e-6)});
      grid.back().x = std::floor(grid.back().x);
      grid.back().y = std::floor(grid.back().y);
    }
  }
  return grid;
}

template <class Code>
void read_window(const Image<Code>& image, int x, int y, int radius, WindowCodes (&out)[3]) {
  const int left = std::max(0, x - radius), right = std::min(image.width() - 1, x + radius);
  const int top = std::max(0, y - radius), bottom = std::min(image.height() - 1, y + radius);
  int sum[3] = {0, 0, 0}, low[3] = {1 << 16, 1 << 16, 1 << 16}, high[3] = {0, 0, 0};
  for (int v = top; v <= bottom; ++v) {
    for (int u = left; u <= right; ++u) {
      for (int c = 0; c < 3; ++c) {
        const int code = image(u, v, c);
        sum[c] += code;
        low[c] = std::min(low[c], code);
        high[c] = std::max(high[c], code);
      }
    }
  }
  const auto count = static_cast<float>((right - left + 1) * (bottom - top + 1));
  for (int c = 0; c < 3; ++c) {
    out[c] = {static_cast<float>(sum[c]) / count, static_cast<float>(low[c]), static_cast<float>(high[c])};
  }
}

/// windows[(i * shots + j) * 3 + c]
std::vector<WindowCodes> read_windows(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo,
                                      const std::vector<Candidate>& grid,
                                      std::span<internal::CodesAtPlaces* const> onlookers) {
  const auto shots = bracket.shots.size();
  const int radius = std::min(bracket.size().width, bracket.size().height) >= 32 ? 1 : 0;
  std::vector<WindowCodes> windows(grid.size() * shots * 3);
  for_rows(static_cast<int>(shots), 1, [&](int first, int last) {
    for (auto j = static_cast<std::size_t>(first); j < static_cast<std::size_t>(last); ++j) {
      const Mat3 photo_from_ref = ref_from_photo.empty() ? Mat3::Identity().eval() : ref_from_photo[j].inverse().eval();
      const Size size = bracket.size();
      const LoadedShot shot(bracket.shots[j]);
      for (internal::CodesAtPlaces* onlooker : onlookers) onlooker->look_at(j, *shot);
      for (std::size_t i = 0; i < grid.size(); ++i) {
        const Vec2 p = (photo_from_ref * Vec3(grid[i].x, grid[i].y, 1)).hnormalized();
        if (!(p.x() > -0.5 && p.y() > -0.5 && p.x() < size.width - 0.5 && p.y() < size.height - 0.5)) continue;
        WindowCodes window[3];
        std::visit(
            [&](const auto& image) {
              read_window(image, static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())), radius,
                          window);
            },
            shot->codes);
        std::copy(window, window + 3, windows.begin() + static_cast<std::ptrdiff_t>((i * shots + j) * 3));
      }
    }
  });
  return windows;
}

struct Ranked {
  std::size_t candidate;
  double brightness;  ///< mean code over the shots, which rises with radiance
  double roughness;   ///< largest range of codes in a window
  int region;
};

/// The smoothest candidates of each bin of brightness, no more than a share from any region of the picture.
std::vector<std::size_t> choose(std::vector<Ranked> ranked, int points) {
  std::vector<std::size_t> chosen;
  if (ranked.empty()) return chosen;
  if (static_cast<int>(ranked.size()) <= points) {
    for (const Ranked& r : ranked) chosen.push_back(r.candidate);
    return chosen;
  }
  std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
    return a.roughness != b.roughness ? a.roughness < b.roughness : a.candidate < b.candidate;
  });
  const auto [low, high] = std::minmax_element(
      ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) { return a.brightness < b.brightness; });
  const double least = low->brightness, width = (high->brightness - least) / kBins + 1e-9;
  const int quota = (points + kBins - 1) / kBins, share = std::max(1, quota / 4);
  std::vector<int> in_bin(kBins);
  std::map<std::pair<int, int>, int> in_region_of_bin;
  for (const Ranked& r : ranked) {
    const int bin = std::clamp(static_cast<int>((r.brightness - least) / width), 0, kBins - 1);
    int& from_region = in_region_of_bin[{bin, r.region}];
    if (in_bin[static_cast<std::size_t>(bin)] >= quota || from_region >= share) continue;
    ++in_bin[static_cast<std::size_t>(bin)];
    ++from_region;
    chosen.push_back(r.candidate);
  }
  return chosen;
}

/// The largest dark code that in most places hardly falls from a shot to the next shorter one. Under any usual response
/// a stop less light lowers a code by a fifth or more; 7 % tells a pedestal, with its noise, from a curve. 0 when there
/// is none.
double find_black_level(const std::vector<WindowCodes>& windows, const Bracket& bracket,
                        const Eigen::VectorXd& ln_exposure, int channel) {
  constexpr int kDarkest = 32;           // in 8-bit codes: a pedestal is not higher
  constexpr double kLeastFall = 0.07;    // of the code, for a stop
  constexpr double kFewestWindows = 20;  // to believe a majority
  const double unit = std::ldexp(1.0, bracket.bits() - 8);
  const std::size_t shots = bracket.shots.size();
  std::array<double, kDarkest> count{}, still{};
  for (std::size_t k = 0; k < windows.size(); k += 3 * shots) {
    for (std::size_t j = 0; j + 1 < shots; ++j) {
      const double stops =
          (ln_exposure[static_cast<Eigen::Index>(j + 1)] - ln_exposure[static_cast<Eigen::Index>(j)]) / std::log(2.0);
      const float shorter = windows[k + 3 * j + static_cast<std::size_t>(channel)].mean;
      const float longer = windows[k + 3 * (j + 1) + static_cast<std::size_t>(channel)].mean;
      const auto code = static_cast<std::size_t>(std::lround(std::isnan(longer) ? 0 : longer / unit));
      if (std::isnan(shorter) || code < 4 || code >= kDarkest || stops < 0.3) continue;
      ++count[code];
      still[code] += longer - shorter < kLeastFall * stops * longer;
    }
  }
  double black = 0;
  for (std::size_t code = 0; code < kDarkest; ++code) {
    if (count[code] >= kFewestWindows && still[code] > 0.5 * count[code]) {
      black = static_cast<double>(code) * unit;
    }
  }
  return black;
}

Eigen::MatrixXd channel_codes(const std::vector<WindowCodes>& windows, const std::vector<Candidate>& grid,
                              const Bracket& bracket, const Eigen::VectorXd& ln_exposure, int channel,
                              double black_level, int points) {
  const auto shots = bracket.shots.size();
  const double clean_white = std::ldexp(252.0 / 256, bracket.bits());
  Eigen::MatrixXd codes(static_cast<Eigen::Index>(grid.size()), static_cast<Eigen::Index>(shots));
  // Its noise reaches a few codes above a pedestal.
  const double clear_of_black = black_level > 0 ? black_level + std::ldexp(3.0, bracket.bits() - 8) : 0;
  std::vector<Ranked> ranked;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    double sum = 0, count = 0, roughness = 0, least = INFINITY, most = -INFINITY;
    for (std::size_t j = 0; j < shots; ++j) {
      const WindowCodes& window = windows[(i * shots + j) * 3 + static_cast<std::size_t>(channel)];
      const UsableCodes usable = usable_codes(bracket.bits(), bracket.shots[j].lossy);
      double& code = codes(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      code = NAN;
      if (std::isnan(window.mean)) continue;
      sum += window.mean;
      ++count;
      // The mean decides, so that noise does not: only a window that touches black or white says less than it seems.
      // By the range, not by the largest code: that would take of the windows near white those whose noise is low.
      const double range = window.largest - window.smallest;
      if (window.smallest < 1 || window.mean + kHeadroom * range > clean_white || !usable.contains(window.mean))
        continue;
      if (window.mean <= clear_of_black) continue;
      code = window.mean;
      roughness = std::max(roughness, static_cast<double>(window.largest - window.smallest));
      least = std::min(least, ln_exposure[static_cast<Eigen::Index>(j)]);
      most = std::max(most, ln_exposure[static_cast<Eigen::Index>(j)]);
    }
    if (!(most - least > 1e-3)) continue;  // says nothing of the response
    const int column = static_cast<int>(grid[i].x * kRegions / bracket.size().width);
    const int row = static_cast<int>(grid[i].y * kRegions / bracket.size().height);
    ranked.push_back({i, sum / count, roughness, row * kRegions + column});
  }
  return codes(choose(std::move(ranked), points), Eigen::all);
}

}  // namespace

Observations sample_points(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo, int points,
                           std::span<internal::CodesAtPlaces* const> onlookers) {
  HDR_ASSERT(ref_from_photo.empty() || ref_from_photo.size() == bracket.shots.size());
  Observations observations;
  observations.bits = bracket.bits();
  observations.ln_exposure.resize(static_cast<Eigen::Index>(bracket.shots.size()));
  for (std::size_t j = 0; j < bracket.shots.size(); ++j) {
    observations.ln_exposure[static_cast<Eigen::Index>(j)] = std::log(bracket.shots[j].relative_exposure());
  }
  const std::vector<Candidate> grid = jittered_grid(bracket.size());
  const std::vector<WindowCodes> windows = read_windows(bracket, ref_from_photo, grid, onlookers);
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<std::size_t>(c);
    const double black = find_black_level(windows, bracket, observations.ln_exposure, c);
    observations.black_level[channel] = black;
    observations.codes[channel] = channel_codes(windows, grid, bracket, observations.ln_exposure, c, black, points);
  }
  return observations;
}

}  // namespace hdr
