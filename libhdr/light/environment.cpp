#include "libhdr/light/environment.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/solid_angle.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

// Share of the sphere above polar angle theta: (1 - cos theta) / 2, without the cancellation near the pole.
double share_above(double polar) {
  const double s = std::sin(0.5 * polar);
  return s * s;
}

// cos and sin of 2 pi t, |t| <= 1/2: Taylor's series about the nearest quarter turn, whose first term left out is below
// 1e-11, far below what a direction in float can say; a fraction of the library's time, and without a branch.
void turn(double t, double& cosine, double& sine) {
  const int quarter = static_cast<int>(4 * t + 4.5) - 4;
  const double x = 2 * kPi * (t - 0.25 * quarter), x2 = x * x;
  // From the last term on. Reciprocals: a division costs as much as five products.
  constexpr double kSine[] = {1.0 / 110, 1.0 / 72, 1.0 / 42, 1.0 / 20, 1.0 / 6};
  constexpr double kCosine[] = {1.0 / 132, 1.0 / 90, 1.0 / 56, 1.0 / 30, 1.0 / 12, 1.0 / 2};
  double s = 1, c = 1;
  for (const double k : kSine) s = 1 - k * x2 * s;
  for (const double k : kCosine) c = 1 - k * x2 * c;
  s *= x;
  const bool swapped = quarter & 1;
  const double of_cosine = swapped ? s : c, of_sine = swapped ? c : s;
  cosine = (quarter + 1) & 2 ? -of_cosine : of_cosine;
  sine = quarter & 2 ? -of_sine : of_sine;
}

// Places in a lat-long, continuous in the column and in the share of the row's solid angle.
struct Place {
  int x, y;
  double across, down;  ///< 0..1 inside the pixel
};

Place place_of(const Vec3f& dir, Size size) {
  const Vec2 uv = latlong_from_dir(dir.cast<double>());
  const double column = uv.x() * size.width;
  const int x = std::clamp(static_cast<int>(column), 0, size.width - 1);
  const int y = std::clamp(static_cast<int>(uv.y() * size.height), 0, size.height - 1);
  const double top = share_above(kPi * y / size.height), bottom = share_above(kPi * (y + 1) / size.height);
  const double down = (share_above(kPi * uv.y()) - top) / (bottom - top);
  return {x, y, std::clamp(column - x, 0.0, 1.0), std::clamp(down, 0.0, 1.0)};
}

}  // namespace

Environment::Environment(Image<float> latlong, Density density, Order order)
    : map_(std::move(latlong)), order_(order), per_width_(1.0 / map_.width()) {
  HDR_ASSERT(map_.channels() == 3 && !map_.empty());
  for (int y = 0; y <= map_.height(); ++y) shares_above_.push_back(share_above(kPi * y / map_.height()));
  weigh(0);
  for (int y = 0; y < map_.height(); ++y)
    power_ += latlong_pixel_solid_angle(y, map_.width(), map_.height()) *
              (order_ == Order::kAlias ? aliases_.row_sum(y) : columns_.row_sum(y));
  if (density == Density::kLuminance || black()) return;
  const double mean = total_ / (4 * kPi);
  weigh(mean);
  // Nothing above its mean (by more than rounding): a grey map, which is sampled as it is.
  if (!(total_ > 1e-9 * mean)) weigh(0);
}

void Environment::weigh(double floor) {
  floor_ = floor;
  if (order_ == Order::kAlias) {
    weigh(aliases_, floor);
  } else {
    weigh(columns_, floor);
  }
}

template <class Columns>
void Environment::weigh(Columns& columns, double floor) {
  columns = Columns(map_, floor);
  std::vector<double> weights, solid_angles;
  for (int y = 0; y < map_.height(); ++y) {
    solid_angles.push_back(latlong_pixel_solid_angle(y, map_.width(), map_.height()));
    weights.push_back(solid_angles.back() * columns.row_total(y));
  }
  rows_ = StepDistribution(weights);
  total_ = rows_.total();
  per_total_ = total_ > 0 ? 1 / total_ : 0;
  // A black map: uniform over the sphere (a row without weight is drawn from uniformly).
  if (!(total_ > 0)) rows_ = StepDistribution(solid_angles);
}

Image<float> latlong_from_probe(const RadianceMap& probe, const Projection& projection, int width) {
  if (is_plain_latlong(projection) && (width == 0 || width == probe.rgb.width())) {
    return probe.rgb.clone();
  }
  constexpr int kLargest = 16384;
  if (width == 0) {
    const double pixels_around = 2 * kPi / std::sqrt(solid_angle_in_middle(projection));
    width = std::clamp(2 * static_cast<int>(std::lround(0.5 * pixels_around)), 2, kLargest);
  }
  const Size size{width, std::max(1, width / 2)};
  return resample(probe.rgb, projection, LatLong{size}, size);
}

Environment Environment::from_probe(const RadianceMap& probe, const Projection& projection, int width,
                                    Density density) {
  return Environment(latlong_from_probe(probe, projection, width), density);
}

Environment::Sample Environment::sample_of(const Vec3f& dir, int x, int y, double weight) const {
  const float* p = map_.pixel(x, y);
  return {dir, Rgbf(p[0], p[1], p[2]), pdf_of_weight(weight)};
}

float Environment::pdf_of_weight(double weight) const {
  return static_cast<float>(black() ? 0.25 / kPi : weight * per_total_);
}

Environment::DensityLaw Environment::density_law() const {
  if (black()) return {static_cast<float>(0.25 / kPi), 0, 0};
  return {0, static_cast<float>(floor_), static_cast<float>(per_total_)};
}

float Environment::pdf_of_pixel(int x, int y) const {
  return pdf_of_weight(weight(x, y));
}

Environment::Sample Environment::sample(const Vec2& u) const {
  const StepDistribution::Step row = rows_.step_of(u.y());
  return sample_at(row,
                   order_ == Order::kAlias ? aliases_.place_of(row.index, u.x()) : columns_.place_of(row.index, u.x()));
}

void Environment::sample(std::span<const Vec2> u, std::span<Sample> samples) const {
  HDR_ASSERT(u.size() == samples.size());
  if (order_ == Order::kAlias) {
    sample_many(aliases_, u, samples);
  } else {
    sample_many(columns_, u, samples);
  }
}

template <class Columns>
void Environment::sample_many(const Columns& columns, std::span<const Vec2> u, std::span<Sample> samples) const {
  constexpr std::size_t kAtOnce = 32;  // as many misses as a processor has open, with some lines each
  StepDistribution::Step rows[kAtOnce];
  typename Columns::Draw draws[kAtOnce];
  for (std::size_t first = 0; first < u.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, u.size() - first);
    for (std::size_t k = 0; k < count; ++k) {
      rows[k] = rows_.step_of(u[first + k].y());
      columns.prefetch_draw(rows[k].index, u[first + k].x());
    }
    for (std::size_t k = 0; k < count; ++k) {
      draws[k] = columns.draw(rows[k].index, u[first + k].x());
      columns.prefetch_pixels(draws[k]);
    }
    for (std::size_t k = 0; k < count; ++k) samples[first + k] = sample_at(rows[k], columns.place_in(draws[k]));
  }
}

Environment::Sample Environment::sample_at(const StepDistribution::Step& row,
                                           const BlockDistribution::Place& column) const {
  double cosine, sine;  // of the azimuth
  turn(0.5 - (column.x + column.inside) * per_width_, cosine, sine);
  // Uniform in solid angle: linear in the share of the sphere above, h = sin^2(theta / 2).
  const auto above = shares_above_.begin() + row.index;
  const double top = above[0], bottom = above[1];
  const double h = top + row.inside * (bottom - top);
  const double horizontal = 2 * std::sqrt(h * (1 - h));
  const Vec3 dir(horizontal * sine, 1 - 2 * h, horizontal * cosine);
  return sample_of(dir.cast<float>(), column.x, row.index, column.weight);
}

Environment::Sample Environment::lookup(const Vec3f& dir) const {
  const Vec2 uv = latlong_from_dir(dir.cast<double>());
  const int x = std::min(static_cast<int>(uv.x() * map_.width()), map_.width() - 1);
  const int y = std::min(static_cast<int>(uv.y() * map_.height()), map_.height() - 1);
  return sample_of(dir, x, y, weight(x, y));
}

Rgbf Environment::smooth_radiance(const Vec3f& dir) const {
  const Vec2 uv = latlong_from_dir(dir.cast<double>());
  const int width = map_.width(), height = map_.height();
  const double x = uv.x() * width - 0.5, y = std::clamp(uv.y() * height - 0.5, 0.0, height - 1.0);
  const double column = std::floor(x);
  const int x0 = (static_cast<int>(column) + width) % width, x1 = (x0 + 1) % width;  // the seam is no edge
  const int y0 = static_cast<int>(y), y1 = std::min(y0 + 1, height - 1);
  const auto fx = static_cast<float>(x - column), fy = static_cast<float>(y - y0);
  const auto at = [this](int i, int j) {
    const float* p = map_.pixel(i, j);
    return Rgbf(p[0], p[1], p[2]);
  };
  const Rgbf top = at(x0, y0) * (1 - fx) + at(x1, y0) * fx;
  const Rgbf bottom = at(x0, y1) * (1 - fx) + at(x1, y1) * fx;
  return top * (1 - fy) + bottom * fy;
}

Vec2 Environment::invert(const Vec3f& dir) const {
  const Place place = place_of(dir, map_.size());
  const BlockDistribution::Place column{place.x, place.across};
  const double across = order_ == Order::kAlias ? aliases_.invert(place.y, column) : columns_.invert(place.y, column);
  return {across, rows_.invert({place.y, place.down})};
}

}  // namespace hdr
