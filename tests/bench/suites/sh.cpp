// Spherical harmonics: how many are enough, and what the sums cost.
#include <fmt/format.h>

#include "libhdr/core/parallel.h"
#include "tests/bench/light_truth.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/suite.h"

namespace hdr::bench {
namespace {

/// Degree against the irradiance of every pixel.
void irradiance_by_degree(Bench& bench) {
  const Image<float> map = light_map(bench, bench.pick(512, 1024));
  const std::vector<Vec3> normals = spiral(300);
  const std::vector<Rgb> truth = irradiance_truth(map, normals);
  const std::string stage =
      fmt::format("irradiance, degree of {}, {}x{}", light_name(bench), map.width(), map.height());
  const auto error_of = [&](const Sh& sh) {
    std::vector<Rgb> answer;
    for (const Vec3& n : normals) answer.push_back(irradiance(sh, n));
    return 100 * rms_of_luminance(answer, truth);
  };
  std::vector<Contender> contenders;
  std::vector<Sh> answers(2 * 13);
  const auto add = [&](int degree, const char* subject, auto&& project_map, Sh& answer) {
    Row row{"sh", stage, subject, "degree"};
    row.value = degree;
    row.error_name = "rms over all normals";
    row.error_unit = "%";
    row.megapixels = megapixels(map.size());
    if (row.ours()) row.setting = fmt::format("hdr sh probe.exr --degree {}", degree);
    contenders.push_back({row, [&answer, project_map, degree] { answer = project_map(degree); },
                          [&answer, error_of] { return error_of(answer); }});
  };
  for (const int degree : {0, 1, 2, 3, 4, 6, 8, 10, 12}) {
    const auto k = static_cast<std::size_t>(degree);
    add(
        degree, "hdr", [&map](int d) { return project(map, LatLong{map.size()}, d); }, answers[k]);
    if (degree == 2 || degree == 4) {
      add(
          degree, "hdr reference", [&map](int d) { return brute_force(map, d); }, answers[13 + k]);
    }
  }
  bench.race(std::move(contenders));
}

/// The nine coefficients against brute force, as the map grows; reading it once is the floor.
void nine_by_megapixels(Bench& bench) {
  const std::string stage = "nine coefficients, by size";
  const int brute_force_to = bench.pick(512, 2048);
  for (const int width :
       bench.quick() ? std::vector<int>{256, 512, 1024, 2048} : std::vector<int>{512, 1024, 2048, 4096, 8192}) {
    const Image<float> map = light_map(bench, width);
    const bool checks = width <= brute_force_to;
    Sh fast, slow;
    volatile float sink = 0;
    Row row{"sh", stage, "hdr", "megapixels"};
    row.value = row.megapixels = megapixels(map.size());
    row.error_name = "of the coefficients, against brute force";
    row.error_unit = "%";
    Row reference = row, reading = row;
    reference.subject = "hdr reference";
    reading.subject = "reading the map once";
    std::vector<Contender> contenders;
    if (checks) contenders.push_back({reference, [&] { slow = brute_force(map, 2); }});
    contenders.push_back(
        {row, [&] { fast = project(map, LatLong{map.size()}, 2); },
         checks ? std::function<double()>([&] { return 100 * relative_error(fast, slow); }) : std::function<double()>(),
         1e-4});
    contenders.push_back({reading, [&] { sink = read_once(map); }});
    bench.race(std::move(contenders));
  }
}

void by_threads(Bench& bench) {
  const Image<float> map = light_map(bench, bench.pick(2048, 4096));
  Row row{"sh", fmt::format("degree 10, {}x{}, by threads", map.width(), map.height()), "hdr", "threads"};
  row.megapixels = megapixels(map.size());
  race_threads(bench, row, [&] { project(map, LatLong{map.size()}, 10); });
}

}  // namespace

void sh_suite(Bench& bench) {
  bench.attempt("sh", "by degree", [&] { irradiance_by_degree(bench); });
  bench.attempt("sh", "by size", [&] { nine_by_megapixels(bench); });
  bench.attempt("sh", "by threads", [&] { by_threads(bench); });
}

}  // namespace hdr::bench
