// A lat-long from a mirror ball: time and error, beside OpenCV's remap with maps that cost it nothing.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/unwrap.h"
#include "tests/bench/rivals/opencv_remap.h"
#include "tests/bench/stopwatch.h"
#include "tests/bench/waves.h"

namespace hdr::bench {
namespace {

/// Decibels below the largest value, over the sphere but for 25 degrees around -Z.
double psnr(const Image<float>& result, const Image<float>& truth) {
  struct Sums {
    double squares = 0, weight = 0, peak = 0;
  };
  const Sums sums = reduce_rows(
      truth.height(), 16, Sums{},
      [&](int first, int last) {
        Sums part;
        for (int y = first; y < last; ++y) {
          const double w = latlong_pixel_solid_angle(y, truth.width(), truth.height());
          for (int x = 0; x < truth.width(); ++x) {
            const Vec3 d = dir_from_latlong((x + 0.5) / truth.width(), (y + 0.5) / truth.height());
            if (d.z() < -std::cos(25 * kDegree)) continue;
            for (int c = 0; c < 3; ++c) {
              const double t = truth(x, y, c), e = result(x, y, c) - t;
              part.squares += w * e * e;
              part.weight += w;
              part.peak = std::max(part.peak, t);
            }
          }
        }
        return part;
      },
      [](Sums& total, const Sums& part) {
        total.squares += part.squares;
        total.weight += part.weight;
        total.peak = std::max(total.peak, part.peak);
      });
  return 10 * std::log10(sums.peak * sums.peak * sums.weight / sums.squares);
}

int run(int width, int ball, double distance, int repeats, int thread_count) {
  set_threads(thread_count);
  const Size size{width, width / 2}, photo{ball, ball * 3 / 4};
  const LatLong latlong{size};
  const MirrorBall from{{0.5 * photo.width, 0.5 * photo.height, 0.48 * photo.height},
                        distance > 0 ? distance : HUGE_VAL};
  const World world(width / 8.0);
  const Image<float> picture = picture_of(world, from, photo), truth = picture_of(world, latlong, size);
  const OpenCvRemap rival(size, [&](int x, int y) {
    const auto px = from.px_from_dir(*latlong.dir_from_px({x + 0.5, y + 0.5}));
    return px.value_or(Vec2::Constant(std::nan("")));
  });
  Image<float> theirs(size, 3), ours(size, 3);  // neither has its memory made while it is timed
  Runs our_runs, their_runs;
  for (int k = 0; k < repeats; ++k) {  // in turn, so that what else the machine does meets both
    our_runs.time([&] { Resampler(picture, from, latlong, size).rows(0, ours); });
    their_runs.time([&] { rival.run(picture, theirs, thread_count); });
  }
  const Seconds us = our_runs.least(), them = their_runs.least();
  const double our_psnr = psnr(ours, truth), their_psnr = psnr(theirs, truth);
  fmt::print("{}x{} lat-long from a ball of {:.0f} px in {:.1f} megapixels, {} threads, least of {}\n", size.width,
             size.height, 2 * from.disc.r, 1e-6 * photo.width * photo.height, threads(), repeats);
  fmt::print("{:<34} {:>8} {:>8} {:>10}\n", "", "wall s", "CPU s", "PSNR dB");
  fmt::print("{:<34} {:>8.3f} {:>8.3f} {:>10.1f}\n", "hdr, with its coordinates", us.wall, us.cpu, our_psnr);
  fmt::print("{:<34} {:>8.3f} {:>8.3f} {:>10.1f}\n", "OpenCV remap Lanczos4, maps given", them.wall, them.cpu,
             their_psnr);
  fmt::print("OpenCV / hdr: {:.2f} times the CPU\n", them.cpu / us.cpu);
  constexpr int kLeastWidth = 2048;  // a small ball is mostly rim, where neither is close
  if (our_psnr > their_psnr || width < kLeastWidth) return 0;
  fmt::print("hdr is no closer to the truth\n");
  return 1;
}

}  // namespace
}  // namespace hdr::bench

int main(int argc, char** argv) {
  CLI::App app("Unwrapping a mirror ball: hdr and OpenCV's remap, time and error");
  int width = 4096, ball = 4000, repeats = 3, thread_count = 2;
  double distance = 20;
  app.add_option("--width", width, "of the lat-long")->capture_default_str();
  app.add_option("--ball", ball, "width of the 4:3 photograph that the ball fills")->capture_default_str();
  app.add_option("--distance", distance, "ball radii; 0: far")->capture_default_str();
  app.add_option("--repeats", repeats, "in turn")->capture_default_str();
  app.add_option("--threads", thread_count, "of both")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  return hdr::bench::run(width, ball, distance, repeats, thread_count);
}
