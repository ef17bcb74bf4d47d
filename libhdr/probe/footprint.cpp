#include "libhdr/probe/internal/footprint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "libhdr/core/parallel.h"

namespace hdr::internal {
namespace {

constexpr int kRowsPerBlock = 32;
constexpr int kRimSamples = 8;  ///< an axis, at least, in a pixel that the source covers partly

/// Positions in the source of the centres of three rows of output pixels, with a column more on each side.
class CentreRows {
 public:
  CentreRows(const SourceFromRun& source_from_run, Size size, int first_row) : map_(source_from_run), size_(size) {
    for (auto& row : rows_) row.resize(static_cast<std::size_t>(size.width) + 2);
    for (int y = first_row - 1; y <= first_row + 1; ++y) fill(y);
  }
  void advance_to(int y) { fill(y + 1); }
  const Vec2& at(int x, int y) const { return rows_[slot(y)][static_cast<std::size_t>(x + 1)]; }
  /// nullptr beyond the output's frame, which says nothing about the source.
  const Vec2* neighbour(int x, int y) const {
    return x >= 0 && y >= 0 && x < size_.width && y < size_.height ? &at(x, y) : nullptr;
  }

 private:
  static std::size_t slot(int y) { return static_cast<std::size_t>((y + 3) % 3); }
  void fill(int y) { map_({-0.5, y + 0.5, 1, size_.width + 2}, rows_[slot(y)].data()); }

  const SourceFromRun& map_;
  Size size_;
  std::array<std::vector<Vec2>, 3> rows_;
};

/// How far the source position moves, in source pixels, from one output pixel to the next along an axis: the larger of
/// the two sides.
struct Stretch {
  double px = 0;
  bool at_edge = false;  ///< one of the points has no place in the source
};

Stretch stretch(const SourcePicture& source, const Vec2* before, const Vec2& centre, const Vec2* after) {
  Stretch result;
  for (const Vec2* neighbour : {before, after}) {
    if (!neighbour) continue;
    if (somewhere(*neighbour) && somewhere(centre)) {
      result.px = std::max(result.px, source.distance(centre, *neighbour));
    } else {
      result.at_edge = true;
    }
  }
  if (!somewhere(centre) && before && after && somewhere(*before) && somewhere(*after)) {
    result.px = 0.5 * source.distance(*before, *after);
  }
  return result;
}

/// At least one sample a source pixel; at an edge of the source enough to tell the covered part.
int samples(const Stretch& along, bool at_edge, int max_samples) {
  constexpr double kRounding = 1e-6;  // a copy at the same scale needs one sample, not two
  constexpr double kDensity = 1.5;    // samples a source pixel: evens out the weights of single pixels
  const double px = std::min(along.px, 1e6) - kRounding;
  const int wanted = px <= 1 ? 1 : static_cast<int>(std::ceil(kDensity * px));
  return std::min(std::max(wanted, at_edge ? kRimSamples : 1), max_samples);
}

/// Source positions around a pixel's centre, u and v in output pixels, as a quadratic through the nine centres.
struct Quadratic {
  Vec2 centre, u, v, uu, vv, uv;
  Vec2 operator()(double du, double dv) const { return centre + du * (u + du * uu + dv * uv) + dv * (v + dv * vv); }
};

/// nullopt where the nine are not all there or bend too much to trust: at seams, poles and rims.
std::optional<Quadratic> quadratic_around(const SourcePicture& source, const CentreRows& centres, int x, int y) {
  constexpr double kMostBend = 0.1;  // third differences are then some hundredths of the pixel's own stretch
  const Vec2& centre = centres.at(x, y);
  Vec2 to[3][3];
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const Vec2* neighbour = centres.neighbour(x + i - 1, y + j - 1);
      if (!neighbour || !somewhere(*neighbour)) return std::nullopt;
      to[j][i] = source.step(centre, *neighbour);
    }
  }
  const Quadratic q{centre,
                    0.5 * (to[1][2] - to[1][0]),
                    0.5 * (to[2][1] - to[0][1]),
                    0.5 * (to[1][2] + to[1][0]),
                    0.5 * (to[2][1] + to[0][1]),
                    0.25 * (to[2][2] - to[2][0] - to[0][2] + to[0][0])};
  const double stretch2 = std::min(q.u.squaredNorm(), q.v.squaredNorm());
  const double bend2 = std::max({q.uu.squaredNorm(), q.vv.squaredNorm(), q.uv.squaredNorm()});
  if (bend2 > kMostBend * kMostBend * stretch2) return std::nullopt;
  return q;
}

class PixelAverage {
 public:
  PixelAverage(const SourcePicture& source, const SourceFromRun& source_from_run, int max_samples)
      : source_(source),
        map_(source_from_run),
        max_samples_(max_samples),
        run_(static_cast<std::size_t>(max_samples)),
        sum_(static_cast<std::size_t>(source.channels())) {}

  void write(const CentreRows& centres, int x, int y, float* mean, float* coverage) {
    const Vec2& centre = centres.at(x, y);
    const Stretch across = stretch(source_, centres.neighbour(x - 1, y), centre, centres.neighbour(x + 1, y));
    const Stretch down = stretch(source_, centres.neighbour(x, y - 1), centre, centres.neighbour(x, y + 1));
    const bool at_edge = across.at_edge || down.at_edge;
    if (!somewhere(centre) && !any_neighbour(centres, x, y)) return;

    std::fill(sum_.begin(), sum_.end(), 0.0);
    const int nx = samples(across, at_edge, max_samples_);
    const int ny = samples(down, at_edge, max_samples_);
    const int covered = nx * ny == 1 ? add(centre) : add_grid(centres, x, y, nx, ny);
    if (covered == 0) return;
    for (std::size_t c = 0; c < sum_.size(); ++c) mean[c] = static_cast<float>(sum_[c] / covered);
    *coverage = static_cast<float>(covered) / static_cast<float>(nx * ny);
  }

 private:
  static bool any_neighbour(const CentreRows& centres, int x, int y) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (somewhere(centres.at(x + dx, y + dy))) return true;
      }
    }
    return false;
  }

  /// Adds nx x ny samples of pixel (x, y); returns how many the source has.
  int add_grid(const CentreRows& centres, int x, int y, int nx, int ny) {
    int covered = 0;
    const auto quadratic = quadratic_around(source_, centres, x, y);
    for (int j = 0; j < ny; ++j) {
      if (!quadratic) map_({x + 0.5 / nx, y + (j + 0.5) / ny, 1.0 / nx, nx}, run_.data());
      for (int i = 0; i < nx; ++i) {
        covered += add(quadratic ? (*quadratic)((i + 0.5) / nx - 0.5, (j + 0.5) / ny - 0.5)
                                 : run_[static_cast<std::size_t>(i)]);
      }
    }
    return covered;
  }

  int add(const Vec2& px) {
    if (!somewhere(px)) return 0;
    source_.add(px, sum_.data());
    return 1;
  }

  const SourcePicture& source_;
  const SourceFromRun& map_;
  int max_samples_;
  std::vector<Vec2> run_;
  std::vector<double> sum_;
};

template <class To>
void directions(const To& to, const PixelRun& run, Vec3* dirs) {
  for (int k = 0; k < run.count; ++k) dirs[k] = to.dir_from_px(run[k]).value_or(Vec3::Constant(kNowhere.x()));
}

template <class From>
void positions(const From& from, const Mat3& source_from_probe, const Vec3* dirs, int count, Vec2* source_px) {
  for (int k = 0; k < count; ++k) {
    source_px[k] = kNowhere;
    if (dirs[k].x() != dirs[k].x()) continue;
    if (const auto px = from.px_from_dir(source_from_probe * dirs[k])) source_px[k] = *px;
  }
}

}  // namespace

SourceFromRun source_from_run(const Projection& from, const Projection& to, const Mat3& source_from_probe) {
  return [=](const PixelRun& run, Vec2* source_px) {
    thread_local std::vector<Vec3> dirs;
    dirs.resize(std::max(dirs.size(), static_cast<std::size_t>(run.count)));
    std::visit([&](const auto& p) { directions(p, run, dirs.data()); }, to);
    std::visit([&](const auto& p) { positions(p, source_from_probe, dirs.data(), run.count, source_px); }, from);
  };
}

Averages average_footprints(const SourcePicture& source, const SourceFromRun& source_from_run, Size size,
                            int max_samples) {
  HDR_ASSERT(max_samples >= 1);
  Averages result{Image<float>(size, source.channels()), Image<float>(size, 1)};
  // A point outside the frame has no place in the source either: a ball may be cut off by its picture.
  const SourceFromRun in_frame = [&](const PixelRun& run, Vec2* source_px) {
    source_from_run(run, source_px);
    for (int k = 0; k < run.count; ++k) {
      if (!source.contains(source_px[k])) source_px[k] = kNowhere;
    }
  };
  for_rows(size.height, kRowsPerBlock, [&](int first, int last) {
    CentreRows centres(in_frame, size, first);
    PixelAverage average(source, in_frame, max_samples);
    for (int y = first; y < last; ++y) {
      if (y > first) centres.advance_to(y);
      for (int x = 0; x < size.width; ++x)
        average.write(centres, x, y, result.mean.pixel(x, y), result.coverage.pixel(x, y));
    }
  });
  return result;
}

}  // namespace hdr::internal
