// Reading, writing and filtering maps against OpenImageIO and OpenCV doing the same, in one run. Every answer is
// checked before it is timed.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "libhdr/core/internal/opencv.h"
#include "libhdr/core/parallel.h"
#include "libhdr/filter/blur.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/bench/exact_gaussian.h"
#include "tests/bench/rivals/openimageio.h"
#include "tests/bench/stopwatch.h"
#include "tests/support/support.h"

namespace hdr::bench {
namespace {

bool all_met = true;

/// Interleaved runs of two ways; `bound`: the most that ours may cost, as a multiple of theirs.
void race(const std::string& what, int repeats, double bound, const std::function<void()>& ours,
          const std::function<void()>& theirs) {
  Runs a, b;
  for (int k = 0; k < repeats; ++k) {
    a.time(ours);
    b.time(theirs);
  }
  const double ratio = a.least().cpu / b.least().cpu;
  all_met &= ratio <= bound;
  fmt::print("{:<34} ours {:7.3f} theirs {:7.3f} CPU s: {:.2f} x, must be <= {:.2f}: {}\n", what, a.least().cpu,
             b.least().cpu, ratio, bound, ratio <= bound ? "met" : "MISSED");
}

void bench_files(const RadianceMap& map, int repeats, const Path& folder) {
  struct Format {
    const char *name, *extension, *compression;
    SampleType type;
    bool oiio_writes;
  };
  static constexpr Format kFormats[] = {{"EXR half piz", ".exr", "piz", SampleType::kHalf, true},
                                        {"EXR half zip", ".exr", "zip", SampleType::kHalf, true},
                                        {"EXR float zip", ".exr", "zip", SampleType::kFloat, true},
                                        {"Radiance HDR", ".hdr", "", SampleType::kFloat, true},
                                        {"TIFF float zip", ".tif", "zip", SampleType::kFloat, true},
                                        {"PFM", ".pfm", "", SampleType::kFloat, false}};
  constexpr double kBound = 1.1;
  for (const Format& format : kFormats) {
    const Path path = folder / (std::string("ours") + format.extension);
    const Path other = folder / (std::string("theirs") + format.extension);
    const auto write = [&] { write_map(path, map, {}, {format.type, format.compression, false}); };
    write();
    const Image<float> theirs = read_by_oiio(path);
    const RadianceMap ours = read_map(path).map;
    if (theirs(77, 33, 1) != ours.rgb(77, 33, 1)) throw Error(std::string(format.name) + ": we and OpenImageIO differ");
    if (format.oiio_writes) {
      race(std::string("write ") + format.name, repeats, kBound, write,
           [&] { write_by_oiio(other, map.rgb, format.type == SampleType::kHalf, format.compression); });
    }
    race(
        std::string("read ") + format.name, repeats, kBound, [&] { read_map(path); }, [&] { read_by_oiio(path); });
  }
}

double energy(const Image<float>& map) {
  double sum = 0;
  for (int y = 0; y < map.height(); ++y) {
    for (std::size_t k = 0; k < map.row_samples(); ++k) sum += map.row(y)[k];
  }
  return sum;
}

/// OpenCV's filter2D with the kernel of a horizontal or slanted line: what it takes when it is given the answer's
/// kernel.
cv::Mat line_kernel(int length, double degrees) {
  Image<float> point(2 * length + 1, 2 * length + 1, 1);
  point(length, length) = 1;
  const Image<float> line = motion_blur(point, length, degrees);
  return internal::mat_from_view(line.view()).clone();
}

void bench_filters(const Image<float>& map, int repeats) {
  const double before = energy(map);
  for (const double sigma : {2.0, 10.0, 50.0}) {
    const Image<float> blurred = gaussian_blur(map, sigma);
    const double error = worst_gaussian_error(map, blurred, sigma), kept = energy(blurred) / before;
    all_met &= error < 1e-3 && std::abs(kept - 1) < 1e-3;
    fmt::print("Gaussian {:g}: {:.1e} from the exact result at worst of 12 pixels, energy {:.6f}\n", sigma, error,
               kept);
    cv::Mat theirs;
    race(
        fmt::format("Gaussian sigma {:g}", sigma), repeats, 1.0, [&] { gaussian_blur(map, sigma); },
        [&] { cv::GaussianBlur(internal::mat_from_view(map.view()), theirs, {}, sigma, sigma, cv::BORDER_REFLECT); });
  }
  for (const double degrees : {0.0, 30.0}) {
    constexpr int kLength = 100;
    const cv::Mat kernel = line_kernel(kLength, degrees);
    const Image<float> blurred = motion_blur(map, kLength, degrees);
    cv::Mat theirs;
    cv::filter2D(internal::mat_from_view(map.view()), theirs, -1, kernel, {-1, -1}, 0, cv::BORDER_REFLECT);
    const double kept = energy(blurred) / before;
    all_met &= std::abs(kept - 1) < 1e-3;
    fmt::print("motion {}@{:g}: energy {:.6f}\n", kLength, degrees, kept);
    race(
        fmt::format("motion {}@{:g}", kLength, degrees), repeats, 1.0, [&] { motion_blur(map, kLength, degrees); },
        [&] {
          cv::filter2D(internal::mat_from_view(map.view()), theirs, -1, kernel, {-1, -1}, 0, cv::BORDER_REFLECT);
        });
  }
  Runs sphere;
  sphere.time([&] { gaussian_blur(map, 50, Surface::kLatLong); });
  fmt::print("Gaussian sigma 50 on the sphere: {:.2f} CPU s\n", sphere.least().cpu);
}

int main(int argc, char** argv) {
  std::string size_text = "8192x4096";
  int repeats = 3, threads_wanted = 0;
  CLI::App app("  files_bench --size 8192x4096\n\nfiles against OpenImageIO, blurs against OpenCV");
  app.add_option("--size", size_text, "of the map, WIDTHxHEIGHT")->capture_default_str();
  app.add_option("--repeats", repeats, "of each piece of work, interleaved")->capture_default_str();
  app.add_option("--threads", threads_wanted, "threads (default: all)");
  bool files = true, filters = true;
  app.add_flag("--files,!--no-files", files, "formats");
  app.add_flag("--filters,!--no-filters", filters, "blurs");
  CLI11_PARSE(app, argc, argv);
  if (threads_wanted > 0) set_threads(threads_wanted);
  Size size;
  if (std::sscanf(size_text.c_str(), "%dx%d", &size.width, &size.height) != 2 || size.width < 128 || size.height < 64) {
    throw Error("--size: give WIDTHxHEIGHT, 128x64 or more");
  }
  cv::setNumThreads(threads());
  RadianceMap map;
  map.rgb = test::test_scene(size.width, size.height, 10, 3);
  for (int c = 0; c < 3; ++c) map.rgb(size.width / 2, size.height / 3, c) = 1e4f;
  const test::ScratchDir scratch;
  fmt::print("{} x {}, {} threads, least of {}\n", size.width, size.height, threads(), repeats);
  if (files) bench_files(map, repeats, scratch.path());
  if (filters) bench_filters(map.rgb, repeats);
  fmt::print("{}\n", all_met ? "all met" : "NOT all met");
  return 0;
}

}  // namespace
}  // namespace hdr::bench

int main(int argc, char** argv) try { return hdr::bench::main(argc, argv); } catch (const std::exception& e) {
  fmt::print(stderr, "files_bench: {}\n", e.what());
  return 1;
}
