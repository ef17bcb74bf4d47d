// The inner loops by themselves, by Google Benchmark: `kernels_bench --benchmark_filter=merge`.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/io/internal/rgbe.h"
#include "libhdr/light/environment.h"
#include "libhdr/light/internal/row_moments.h"
#include "libhdr/probe/unwrap.h"
#include "libhdr/response/expose.h"
#include "tests/bench/light_truth.h"
#include "tests/bench/merged_rows.h"
#include "tests/support/scene.h"

namespace hdr::bench {
namespace {

Bracket small_bracket() {
  const Image<float> scene = test::test_scene(512, 128, 12, 1);
  Bracket bracket;
  for (int k = 0; k < 7; ++k) {
    Exposure exposure;
    exposure.seconds = std::exp2(2 * k - 6);
    bracket.shots.push_back(expose(scene, exposure, {srgb_response(8), NoiseModel{}, 0.18}, 1));
    bracket.input_order.push_back(k);
  }
  return bracket;
}

/// Samples of all shots a second.
void merge_rows(benchmark::State& state, WeightKind weight, RowKernel kernel) {
  static const Bracket bracket = small_bracket();
  const Response response = srgb_response(8);
  for (auto _ : state) benchmark::DoNotOptimize(merged_rows(bracket, response, weight, kernel).rgb.row(0));
  state.SetItemsProcessed(state.iterations() * 512 * 128 * 3 * 7);
}
BENCHMARK_CAPTURE(merge_rows, likelihood, WeightKind::kVariance, RowKernel::kFast);
BENCHMARK_CAPTURE(merge_rows, likelihood_every_tile, WeightKind::kVariance, RowKernel::kEveryTile);
BENCHMARK_CAPTURE(merge_rows, likelihood_reference, WeightKind::kVariance, RowKernel::kReference);
BENCHMARK_CAPTURE(merge_rows, hat, WeightKind::kHat, RowKernel::kFast);
BENCHMARK_CAPTURE(merge_rows, hat_reference, WeightKind::kHat, RowKernel::kReference);

/// Pixels of the output a second.
void resample_rows(benchmark::State& state) {
  const Size size{512, 256};
  const Image<float> ball = test::test_scene(512, 512, 8, 2);
  const MirrorBall from{{256, 256, 250}, 20};
  for (auto _ : state) benchmark::DoNotOptimize(resample(ball, from, LatLong{size}, size).row(0));
  state.SetItemsProcessed(state.iterations() * size.width * size.height);
}
BENCHMARK(resample_rows);

/// Bytes of the map a second.
void moments(benchmark::State& state, void (*kernel)(View<const float>, const AzimuthTable&, double*)) {
  static const Image<float> map = sky(1024);
  const AzimuthTable table(map.width(), static_cast<int>(state.range(0)));
  std::vector<double> out(static_cast<std::size_t>(map.height()) * static_cast<std::size_t>(table.count()) * 3);
  for (auto _ : state) {
    kernel(map, table, out.data());
    benchmark::DoNotOptimize(out.data());
  }
  state.SetBytesProcessed(state.iterations() * 1024 * 512 * 3 * 4);
}
BENCHMARK_CAPTURE(moments, simd, row_moments)->Arg(2)->Arg(10);
BENCHMARK_CAPTURE(moments, reference, reference::row_moments)->Arg(2)->Arg(10);

/// Samples a second.
void environment_sample(benchmark::State& state) {
  static const Environment light(sky(2048));
  Random random(1, 2);
  std::vector<Vec2> u(256);
  std::vector<Environment::Sample> samples(u.size());
  for (Vec2& v : u) v = {random.uniform(), random.uniform()};
  for (auto _ : state) {
    light.sample(u, samples);
    benchmark::DoNotOptimize(samples.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(u.size()));
}
BENCHMARK(environment_sample);

/// Pixels a second.
void rgbe_pack(benchmark::State& state) {
  static const Image<float> map = test::test_scene(1024, 64, 10, 3);
  std::vector<std::uint8_t> bytes(4 * 1024);
  for (auto _ : state) {
    for (int y = 0; y < map.height(); ++y) {
      for (int x = 0; x < map.width(); ++x) {
        const internal::Rgbe packed = internal::rgbe_from_rgb(map.pixel(x, y));
        std::copy(packed.begin(), packed.end(), bytes.begin() + 4 * x);
      }
      benchmark::DoNotOptimize(bytes.data());
    }
  }
  state.SetItemsProcessed(state.iterations() * 1024 * 64);
}
BENCHMARK(rgbe_pack);

}  // namespace
}  // namespace hdr::bench

int main(int argc, char** argv) {
  hdr::set_threads(1);  // kernels, not their sharing out
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
