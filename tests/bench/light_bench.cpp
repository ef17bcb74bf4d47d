// Light from a probe: harmonics, sampling, lights and transfer, against brute force and against one pass over the map.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/io/read.h"
#include "libhdr/light/environment.h"
#include "libhdr/light/lights.h"
#include "libhdr/light/sh.h"
#include "libhdr/light/sh_fit.h"
#include "libhdr/render/prt.h"
#include "libhdr/render/scene_file.h"
#include "tests/bench/light_truth.h"
#include "tests/bench/stopwatch.h"
#include "tests/support/support.h"

namespace hdr::bench {
namespace {

bool all_right = true, all_met = true;
volatile float sink = 0;  ///< what was computed is used: no compiler leaves it out

const char* verdict(bool met) {
  all_met = all_met && met;
  return met ? "met" : "MISSED";
}

// Between two timed runs: nothing of the map is left in a cache, so that reading it once is reading memory.
void forget_caches() {
  static std::vector<float> other(32u << 20, 1.0f);
  for (std::size_t k = 0; k < other.size(); k += 16) other[k] += 1;
  sink = other[12345];
}

void bench_sh(const std::vector<int>& widths, int brute_force_to, int repeats) {
  fmt::print(
      "harmonics (must: error <= 1e-7, time <= 4 reads)\n  width degree  error     read ms   sh ms  reads (CPU)\n");
  for (const int width : widths) {
    const Image<float> map = sky(width);
    for (const int degree : {2, 10}) {
      const Sh fast = project(map, LatLong{map.size()}, degree);
      const bool check = width * degree <= brute_force_to;
      const double error = check ? relative_error(fast, brute_force(map, degree)) : NAN;
      Runs reads, projections;
      for (int k = 0; k < repeats; ++k) {
        forget_caches();
        sink = reads.time([&] { return read_once(map); });
        forget_caches();
        projections.time([&] { return project(map, LatLong{map.size()}, degree); });
      }
      const double ratio = projections.least().cpu / reads.least().cpu;
      all_right = all_right && !(error > 1e-6);
      fmt::print("  {:5d} {:6d}  {:8.1e} {:8.2f} {:8.2f} {:8.1f}  {}\n", width, degree, error, 1e3 * reads.least().wall,
                 1e3 * projections.least().wall, ratio, verdict(!(error > 1e-7) && ratio <= 4));
      std::fflush(stdout);
    }
  }
}

// Millions of samples a second of one core: many at once, and one by one.
struct Rates {
  double many, single;
};
Rates rates_of(const Environment& light, int repeats) {
  constexpr int kSamples = 1 << 20;
  constexpr int kBatch = 256;
  std::vector<Vec2> u(kBatch);
  std::vector<Environment::Sample> samples(kBatch);
  Runs batches, singles;
  for (int run = 0; run < repeats; ++run) {
    batches.time([&] {
      Random random(1, 2);
      float sum = 0;
      for (int k = 0; k < kSamples; k += kBatch) {
        for (Vec2& v : u) v = {random.uniform(), random.uniform()};
        light.sample(u, samples);
        for (const Environment::Sample& s : samples) sum += s.pdf;
      }
      sink = sum;
    });
    singles.time([&] {
      Random random(1, 2);
      float sum = 0;
      for (int k = 0; k < kSamples; ++k) {
        const double x = random.uniform();
        sum += light.sample({x, random.uniform()}).pdf;
      }
      sink = sum;
    });
  }
  return {kSamples / batches.least().cpu / 1e6, kSamples / singles.least().cpu / 1e6};
}

// Rms over random normals of the error of irradiance from 64 samples, relative: of points that are spread evenly
// (Hammersley's, shifted), which an order along the row keeps even.
double error_of_64(const Environment& light) {
  constexpr int kPoints = 64, kNormals = 400;
  const Sh sh = project(light.latlong(), LatLong{light.latlong().size()}, 12);
  double square = 0;
  Random random(3, 3);
  for (int k = 0; k < kNormals; ++k) {
    const Vec3 n = Vec3(random.normal(), random.normal(), random.normal()).normalized();
    const double du = random.uniform(), dv = random.uniform(), truth = irradiance(sh, n)[1];
    double sum = 0;
    for (int i = 0; i < kPoints; ++i) {
      double u = du, v = dv + i * 1.0 / kPoints;
      for (int bits = i, digit = 1; bits; bits /= 2, ++digit) u += std::ldexp(bits % 2, -digit);
      const Environment::Sample s = light.sample({u - std::floor(u), v - std::floor(v)});
      sum += std::max(0.0, n.dot(s.dir.cast<double>())) * s.radiance[1] / s.pdf / kPoints;
    }
    square += std::pow(sum / truth - 1, 2) / kNormals;
  }
  return std::sqrt(square);
}

void bench_environment(int width, int repeats) {
  const Image<float> map = sky(width);
  fmt::print("sampling, {} wide (must: tables <= 3 passes, >= 10 M samples/s a core)\n", width);
  for (const auto order : {Environment::Order::kInOrder, Environment::Order::kAlias}) {
    Runs passes, builds;
    for (int k = 0; k < repeats; ++k) {
      sink = passes.time([&] { return read_once(map); });
      Image<float> own = map.clone();
      builds.time([&] { return Environment(std::move(own), Environment::Density::kLuminance, order); });
    }
    const Environment light(map.clone(), Environment::Density::kLuminance, order);
    const Rates rates = rates_of(light, repeats);
    const double ratio = builds.least().cpu / passes.least().cpu;
    const bool chosen = order == Environment::Order::kInOrder;  // the other is there to be compared
    fmt::print(
        "  {:<12} {:.1f} passes {}, many at once {:.1f} M/s {}, one by one {:.1f} M/s {}; 64 even points: {:.1f} %\n",
        chosen ? "in order" : "alias tables", ratio, chosen ? verdict(ratio <= 3) : "", rates.many,
        chosen ? verdict(rates.many >= 10) : "", rates.single, chosen ? verdict(rates.single >= 10) : "",
        100 * error_of_64(light));
  }
}

struct IrradianceError {
  double mean = 0, largest = 0;  ///< of luminance, relative to its largest
  double worst_channel = 0;      ///< relative to the largest that the expansion says
};
IrradianceError irradiance_error(const Sh& sh, const std::vector<Vec3>& normals, const std::vector<Rgb>& truth) {
  IrradianceError error;
  Rgb largest_sh = Rgb::Zero(), worst = Rgb::Zero();
  double largest = 0;
  const auto y = [](const Rgb& c) { return luminance(c[0], c[1], c[2]); };
  for (std::size_t k = 0; k < normals.size(); ++k) {
    const Rgb e = irradiance(sh, normals[k]);
    largest_sh = largest_sh.max(e);
    worst = worst.max((e - truth[k]).abs());
    largest = std::max(largest, y(truth[k]));
    error.largest = std::max(error.largest, std::abs(y(e) - y(truth[k])));
    error.mean += std::abs(y(e) - y(truth[k])) / static_cast<double>(normals.size());
  }
  return {error.mean / largest, error.largest / largest, (worst / largest_sh).maxCoeff()};
}

// Of degree 2 against the sum over all pixels; the bound in every channel.
void bench_irradiance(const std::string& name, View<const float> map) {
  const Sh sh = project(map, LatLong{map.size()}, 2), fit = fit_irradiance(map, 2).sh;
  const std::vector<Vec3> normals = spiral(400);
  const std::vector<Rgb> truth = irradiance_truth(map, normals);
  const IrradianceError error = irradiance_error(sh, normals, truth), fitted = irradiance_error(fit, normals, truth);
  const double bound = irradiance_error_bound(map, LatLong{map.size()}, sh);
  const bool safe = bound >= error.worst_channel;
  all_right = all_right && safe;
  fmt::print("  {:<12} {:6.2f} % {:6.2f} %  bound {:6.2f} %  {}; fitted {:6.2f} % {:6.2f} % {}\n", name,
             100 * error.mean, 100 * error.largest, 100 * bound, verdict(error.largest <= 0.09), 100 * fitted.mean,
             100 * fitted.largest, safe ? "" : "THE BOUND IS BELOW THE ERROR");
}

// Against every pixel of the map, on normals that the placement did not see.
double rms_against_pixels(const std::vector<DirectionalLight>& lights, const std::vector<DirectionalLight>& pixels) {
  double off = 0, size = 0;
  for (const Vec3& n : spiral(300)) {
    const Rgb a = irradiance(lights, n), b = irradiance(pixels, n);
    const double e = luminance(b[0], b[1], b[2]);
    off += std::pow(luminance(a[0], a[1], a[2]) - e, 2);
    size += e * e;
  }
  return std::sqrt(off / size);
}

void bench_lights(const std::string& name, View<const float> map, std::array<int, 2>& better) {
  const std::vector<DirectionalLight> pixels = pixel_lights(map);
  fmt::print("  {:<12}", name);
  for (const int count : {16, 64}) {
    double of_method[4];
    int k = 0;
    for (const LightsMethod method : {LightsMethod::kMedianCut, LightsMethod::kVarianceCut, LightsMethod::kStructured,
                                      LightsMethod::kKolligKeller}) {
      of_method[k] = rms_against_pixels(make_lights(map, {count, method, std::nullopt, 1}).lights, pixels);
      fmt::print(" {:6.3f}", 100 * of_method[k++]);
    }
    const double must = count == 64 ? 0.007 : 0.03;
    fmt::print("  {}  ", verdict(of_method[1] <= must && of_method[2] <= must));
    if (count == 64) {
      better[0] += of_method[1] < of_method[0];
      better[1] += of_method[2] < of_method[0];
    }
  }
  fmt::print("\n");
  std::fflush(stdout);
}

void bench_maps(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".hdr") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  fmt::print(
      "irradiance of degree 2, mean and largest error of luminance, of the largest E (must: <= 9 %), of the projection "
      "and of the fit for the least largest error\n");
  for (const auto& file : files) bench_irradiance(file.stem().string(), read_map(file).map.rgb);
  fmt::print(
      "lights, rms of irradiance in percent (must: structured, variance <= 3 with 16, <= .7 with 64)\n  {:<12} 16: "
      "median "
      "variance structured kollig-keller; 64: the same\n",
      "map");
  std::array<int, 2> better{};
  for (const auto& file : files) bench_lights(file.stem().string(), read_map(file).map.rgb, better);
  fmt::print("  better than median cut with 64: variance cut on {}, structured on {} of {} maps\n", better[0],
             better[1], files.size());
}

void bench_lights_time(int width) {
  const Image<float> map = sky(width);
  for (const auto& [name, method] :
       {std::pair("structured", LightsMethod::kStructured), std::pair("variance cut", LightsMethod::kVarianceCut)}) {
    Runs runs;
    for (int k = 0; k < 2; ++k) runs.time([&] { return make_lights(map, {64, method, std::nullopt, 1}); });
    fmt::print("64 lights of {}x{}, {} (must: < 1 s): {:.2f} CPU s {}\n", width, width / 2, name, runs.least().cpu,
               verdict(runs.least().cpu < 1));
  }
}

void bench_prt(const std::filesystem::path& file, int samples) {
  Scene scene;
  scene.meshes.push_back(with_smooth_normals(joined(read_scene(file, {Shading::kFlat}).scene)));
  Runs transfers, relights;
  const std::vector<Transfer> transfer = transfers.time([&] { return diffuse_transfer(scene, {4, samples, 1, {}}); });
  const Image<float> map = sky(256);
  const Sh light = project(map, LatLong{map.size()}, 4);
  for (int k = 0; k < 20; ++k) sink = relights.time([&] { return relit(transfer[0], light); })(0, 0);
  fmt::print("transfer of {} vertices, {} rays each: {:.1f} CPU s; lit (must: < 2 ms): {:.2f} CPU ms {}\n",
             scene.meshes[0].positions.size(), samples, transfers.least().cpu, 1e3 * relights.least().cpu,
             verdict(relights.least().cpu < 2e-3));
}

int main(int argc, char** argv) {
  bool quick = false, strict = false;
  std::string only;
  CLI::App app("  light_bench\n\nlight from a probe: error and time");
  app.add_flag("--quick", quick, "small maps: answers, not times");
  app.add_option("--only", only, "sh, sampling, maps, lights or prt");
  app.add_flag("--strict", strict, "exit 1 when a figure is missed, not only when an answer is wrong");
  CLI11_PARSE(app, argc, argv);
  const auto wanted = [&](const char* part) { return only.empty() || only == part; };
  if (wanted("sh")) bench_sh(quick ? std::vector<int>{256} : std::vector<int>{1024, 4096, 8192}, 20000, quick ? 2 : 7);
  if (wanted("sampling")) bench_environment(quick ? 1024 : 8192, quick ? 2 : 5);
  const auto maps = test::shared_data("envmaps/polyhaven_1k"), bunny = test::shared_data("meshes/stanford-bunny.obj");
  if (!maps || !bunny) fmt::print("no ../shared/data here: real maps and meshes are skipped\n");
  if (wanted("maps") && maps && !quick) bench_maps(*maps);
  if (wanted("lights")) bench_lights_time(quick ? 1024 : 4096);
  if (wanted("prt") && bunny && !quick) bench_prt(*bunny, 256);
  if (!all_right) fmt::print(stderr, "light_bench: an answer is wrong\n");
  return all_right && (all_met || !strict) ? 0 : 1;
}

}  // namespace
}  // namespace hdr::bench

int main(int argc, char** argv) try { return hdr::bench::main(argc, argv); } catch (const std::exception& e) {
  fmt::print(stderr, "light_bench: {}\n", e.what());
  return 1;
}
