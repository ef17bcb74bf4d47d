// A probe as a few directional lights: how many are enough.
#include "libhdr/light/lights.h"

#include <fmt/format.h>

#include "tests/bench/light_truth.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/suite.h"

namespace hdr::bench {
namespace {

struct Method {
  LightsMethod method;
  const char* name;
};
constexpr Method kMethods[] = {{LightsMethod::kStructured, "structured"},
                               {LightsMethod::kVarianceCut, "variance-cut"},
                               {LightsMethod::kMedianCut, "median-cut"},
                               {LightsMethod::kKolligKeller, "kollig-keller"}};

void by_count(Bench& bench) {
  const Image<float> map = light_map(bench, bench.pick(256, 1024));
  const std::vector<Vec3> normals = spiral(300);
  const std::vector<Rgb> truth = irradiance_truth(map, normals);
  std::vector<Contender> contenders;
  const auto counts = bench.quick() ? std::vector<int>{4, 16, 64, 256} : std::vector<int>{4, 8, 16, 32, 64, 128, 256};
  std::vector<Lights> answers(counts.size() * std::size(kMethods));
  std::size_t next = 0;
  for (const Method& method : kMethods) {
    for (const int count : counts) {
      Lights& answer = answers[next++];
      Row row{"lights",
              fmt::format("irradiance from N lights of {}, {}x{}", light_name(bench), map.width(), map.height()),
              std::string("hdr ") + method.name, "lights"};
      row.value = count;
      row.error_name = "rms over all normals";
      row.error_unit = "%";
      row.megapixels = megapixels(map.size());
      row.setting = fmt::format("hdr lights probe.exr -n {} --method {}", count, method.name);
      const LightsOptions options{count, method.method, std::nullopt, 1};
      contenders.push_back({row, [&answer, &map, options] { answer = make_lights(map, options); },
                            [&answer, &normals, &truth] {
                              std::vector<Rgb> irradiances;
                              for (const Vec3& n : normals) irradiances.push_back(irradiance(answer.lights, n));
                              return 100 * rms_of_luminance(irradiances, truth);
                            }});
    }
  }
  bench.race(std::move(contenders));
}

void by_megapixels(Bench& bench) {
  for (const int width : bench.quick() ? std::vector<int>{256, 512, 1024} : std::vector<int>{512, 1024, 2048, 4096}) {
    const Image<float> map = light_map(bench, width);
    Row row{"lights", "64 lights, by size", "hdr structured", "megapixels"};
    row.value = row.megapixels = megapixels(map.size());
    Row cut = row;
    cut.subject = "hdr variance-cut";
    bench.race({{row,
                 [&] {
                   make_lights(map, {64, LightsMethod::kStructured, std::nullopt, 1});
                 }},
                {cut, [&] {
                   make_lights(map, {64, LightsMethod::kVarianceCut, std::nullopt, 1});
                 }}});
  }
}

}  // namespace

void lights_suite(Bench& bench) {
  bench.attempt("lights", "by number", [&] { by_count(bench); });
  bench.attempt("lights", "by size", [&] { by_megapixels(bench); });
}

}  // namespace hdr::bench
