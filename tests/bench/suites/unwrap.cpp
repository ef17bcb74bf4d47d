// A lat-long from a mirror ball: which width, and what OpenCV's kernels need for theirs.
#include "libhdr/probe/unwrap.h"

#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "tests/bench/rivals/opencv_remap.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/suite.h"
#include "tests/bench/waves.h"

namespace hdr::bench {
namespace {

constexpr double kBlindSpot = 25;  // degrees around -Z, where a ball shows the world in its last pixels

struct Ball {
  World world;
  MirrorBall projection;
  Image<float> photo;
};

/// A world whose finest waves a probe of `width` holds with four pixels a period and more.
Ball ball_of(int photo_width, int width) {
  const Size size{photo_width, photo_width * 3 / 4};
  Ball ball{World(width / 8.0), MirrorBall{{0.5 * size.width, 0.5 * size.height, 0.48 * size.height}, 20}, {}};
  ball.photo = picture_of(ball.world, ball.projection, size);
  return ball;
}

double root_mean_square(const std::vector<Vec3>& dirs, const World& world,
                        const std::function<void(const Vec3&, float*)>& shown) {
  double squares = 0, count = 0;
  for (const Vec3& d : dirs) {
    float truth[3], answer[3];
    world.at(d, truth);
    shown(d, answer);
    for (int c = 0; c < 3; ++c) squares += std::pow(answer[c] - truth[c], 2);
    count += 3;
  }
  return 100 * std::sqrt(squares / count);  // the world's mean is 1
}

std::vector<Vec3> directions(int count) {
  Random random(11, 3);
  std::vector<Vec3> dirs;
  while (static_cast<int>(dirs.size()) < count) {
    const double z = 2 * random.uniform() - 1, a = 2 * kPi * random.uniform(), s = std::sqrt(1 - z * z);
    if (z > -std::cos(kBlindSpot * kDegree)) dirs.emplace_back(s * std::cos(a), s * std::sin(a), z);
  }
  return dirs;
}

/// Between pixel centres, over the seam.
void bilinear(const Image<float>& map, const Vec3& d, float* rgb) {
  const Vec2 px = *LatLong{map.size()}.px_from_dir(d);
  const double u = px.x() - 0.5, v = std::clamp(px.y() - 0.5, 0.0, map.height() - 1.0);
  const int left = static_cast<int>(std::floor(u)), top = std::min(static_cast<int>(v), map.height() - 2);
  const auto s = static_cast<float>(u - left), t = static_cast<float>(v - top);
  const int w = map.width(), x0 = (left + w) % w, x1 = (left + 1 + w) % w;
  for (int c = 0; c < 3; ++c) {
    rgb[c] = (1 - t) * ((1 - s) * map(x0, top, c) + s * map(x1, top, c)) +
             t * ((1 - s) * map(x0, top + 1, c) + s * map(x1, top + 1, c));
  }
}

Row row_of(const std::string& stage, const std::string& subject, const char* knob, Size size) {
  Row row{"unwrap", stage, subject, knob};
  row.error_name = "rms of radiance, but for 25 degrees behind the ball";
  row.error_unit = "%";
  row.megapixels = megapixels(size);
  return row;
}

/// How wide a probe must be: what its user finds between its pixels.
void by_width(Bench& bench) {
  const int photo = bench.pick(1200, 4000), finest = bench.pick(512, 2048);
  const Ball ball = ball_of(photo, finest);
  const std::vector<Vec3> dirs = directions(20000);
  const std::string stage = fmt::format("looked up in a lat-long from a ball of {:.0f} px", 2 * ball.projection.disc.r);
  std::vector<Contender> contenders;
  std::vector<Image<float>> answers(6);
  for (int k = 0; k < 6; ++k) {
    const int width = finest / 4 << k;
    if (width > 8192) break;
    Image<float>& answer = answers[static_cast<std::size_t>(k)];
    Row row = row_of(stage, "hdr", "width", {width, width / 2});
    row.value = width;
    row.setting = fmt::format("hdr unwrap ball.exr --from mirror-ball --to latlong --width {} -o probe.exr", width);
    contenders.push_back({row,
                          [&answer, &ball, width] {
                            const Size size{width, width / 2};
                            answer = resample(ball.photo, ball.projection, LatLong{size}, size);
                          },
                          [&answer, &ball, &dirs] {
                            return root_mean_square(dirs, ball.world,
                                                    [&](const Vec3& d, float* rgb) { bilinear(answer, d, rgb); });
                          }});
  }
  bench.race(std::move(contenders));
}

/// OpenCV is given the coordinates, in its own fixed-point form, for nothing.
void against_remap(Bench& bench) {
  const int width = bench.pick(1024, 4096);
  const Size size{width, width / 2};
  const Ball ball = ball_of(bench.pick(1000, 4000), width);
  const LatLong latlong{size};
  const std::string stage = fmt::format("at the pixels of a {}x{} lat-long", size.width, size.height);
  const OpenCvRemap remap(size, [&](int x, int y) {
    return ball.projection.px_from_dir(*latlong.dir_from_px({x + 0.5, y + 0.5})).value_or(Vec2::Constant(std::nan("")));
  });
  Image<float> ours, theirs(size, 3);
  const auto error = [&](const Image<float>& map) {
    std::vector<Vec3> dirs;
    for (int y = 0; y < size.height; y += 4) {
      for (int x = 0; x < size.width; x += 4) {
        const Vec3 d = dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height);
        if (d.z() > -std::cos(kBlindSpot * kDegree)) dirs.push_back(d);
      }
    }
    return root_mean_square(dirs, ball.world, [&](const Vec3& d, float* rgb) {
      const Vec2 px = *latlong.px_from_dir(d);
      const float* p = map.pixel(static_cast<int>(px.x()), static_cast<int>(px.y()));
      std::copy(p, p + 3, rgb);
    });
  };
  std::vector<Contender> contenders;
  Row row = row_of(stage, "hdr, coordinates included", "kernel", size);
  row.label = "fitted";
  contenders.push_back(
      {row, [&] { ours = resample(ball.photo, ball.projection, latlong, size); }, [&] { return error(ours); }});
  const struct {
    RemapKernel kernel;
    const char* name;
  } kernels[] = {
      {RemapKernel::kLinear, "linear"}, {RemapKernel::kCubic, "cubic"}, {RemapKernel::kLanczos4, "Lanczos4"}};
  for (const auto& k : kernels) {
    Row other = row_of(stage, "OpenCV remap, coordinates given", "kernel", size);
    other.label = k.name;
    contenders.push_back({other, [&, kernel = k.kernel] { remap.run(ball.photo, theirs, threads(), kernel); },
                          [&] { return error(theirs); }});
  }
  bench.race(std::move(contenders));
}

void by_threads(Bench& bench) {
  const int width = bench.pick(1024, 4096);
  const Size size{width, width / 2};
  const Ball ball = ball_of(bench.pick(1000, 4000), width);
  Row row{"unwrap", fmt::format("{}x{}, by threads", size.width, size.height), "hdr", "threads"};
  row.megapixels = megapixels(size);
  race_threads(bench, row, [&] { resample(ball.photo, ball.projection, LatLong{size}, size); });
}

}  // namespace

void unwrap_suite(Bench& bench) {
  bench.attempt("unwrap", "by width", [&] { by_width(bench); });
  bench.attempt("unwrap", "by kernel", [&] { against_remap(bench); });
  bench.attempt("unwrap", "by threads", [&] { by_threads(bench); });
}

}  // namespace hdr::bench
