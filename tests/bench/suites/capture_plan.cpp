// Which exposures a scene needs: the planner's few against grids, by what they miss and how long the camera is busy.
#include <fmt/format.h>

#include <cmath>

#include "capture/shoot.h"
#include "capture/virtual/virtual_camera.h"
#include "libhdr/core/random.h"
#include "libhdr/response/response.h"
#include "tests/bench/stopwatch.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/suite.h"
#include "tests/support/scene.h"
#include "tests/unit/capture/cover.h"

namespace hdr::bench {
namespace {

struct Place {
  double stops = 0;
  Image<float> scene;
  VirtualCameraOptions camera;
};

/// Scenes of 6 to 18 stops before a camera that says with which exposure a frame was taken.
std::vector<Place> places(int count) {
  std::vector<Place> all;
  for (int k = 0; k < count; ++k) {
    const auto seed = static_cast<std::uint64_t>(k) + 1;
    Place place;
    place.stops = 6 + 12.0 * k / std::max(1, count - 1);
    place.scene = test::test_scene(96, 72, place.stops, seed);
    place.camera.seconds = {1.0 / 32000, 4, 0};
    place.camera.seed = seed;
    all.push_back(std::move(place));
  }
  return all;
}

/// Codes 16 to 250 of 255, as levels of full well.
test::Levels levels_of(const Response& response) {
  test::Levels levels{0, 1};
  for (int c = 0; c < 3; ++c) {
    const double full = response.exposure(c, 255);
    levels.floor = std::max(levels.floor, response.exposure(c, 16) / full);
    levels.ceiling = std::min(levels.ceiling, response.exposure(c, 250) / full);
  }
  return levels;
}

/// Of all places together.
struct Sums {
  double shots = 0, missed = 0, camera_seconds = 0, count = 0;
};

void add_take(const Place& place, const BracketRequest& request, Sums& sums) {
  VirtualCamera camera("virtual:", place.scene.clone(), place.camera);
  camera.configure({});
  const Take take = shoot(camera, request);
  Exposure metered = place.camera.optics;
  metered.seconds = 1.0 / 60;
  // Of full well, for unit radiance in one second.
  const double sensitivity =
      metered_sensitivity(place.scene, metered, place.camera.level) * 60 * metered.relative().value();
  std::vector<double> exposures;
  for (const PlannedShot& shot : take.plan.shots) exposures.push_back(shot.setting.total());
  const test::Levels levels = levels_of(*response_from_name(place.camera.response, 8));
  const std::vector<double> light =
      test::samples_to_show(place.scene, sensitivity, levels, place.camera.seconds.min, place.camera.seconds.max);
  sums.shots += static_cast<double>(take.plan.shots.size());
  sums.missed += test::share_missed(light, exposures, levels);
  sums.camera_seconds += take.prepare_seconds + take.probe_seconds + take.bracket_seconds;
  ++sums.count;
}

void measure(Bench& bench, const std::vector<Place>& all, const std::string& subject, const std::string& setting,
             const BracketRequest& request) {
  Row row{"capture-plan", fmt::format("{} scenes of 6 to 18 stops before a virtual camera", all.size()), subject,
          "shots"};
  row.setting = setting;
  row.threads = 1;
  const Stopwatch watch;
  Sums sums;
  try {
    for (const Place& place : all) add_take(place, request, sums);
  } catch (const std::exception& e) {
    row.label = request.grid ? std::to_string(request.grid->count) : "planned";
    row.note = std::string("not timed: ") + e.what();
    bench.add(row);
    return;
  }
  const Seconds spent = watch.elapsed();
  row.value = sums.shots / sums.count;
  row.error = 100 * sums.missed / sums.count;
  row.error_name = "samples that no shot shows";
  row.error_unit = "%";
  row.cpu_seconds = row.median_cpu_seconds = spent.cpu / sums.count;
  row.wall_seconds = sums.camera_seconds / sums.count;
  row.time_name = "s that the camera is busy, a scene";
  row.megapixels = megapixels(all[0].scene.size());
  bench.add(row);
}

}  // namespace

void capture_plan_suite(Bench& bench) {
  const std::vector<Place> all = places(bench.pick(5, 25));
  BracketRequest automatic;
  measure(bench, all, "hdr, planned", "hdr shoot --auto", automatic);
  automatic.response_known = true;
  measure(bench, all, "hdr, planned, response known", "hdr shoot --auto --response srgb", automatic);
  for (const double stops : {1.0, 2.0, 3.0}) {
    for (const int count : {3, 5, 7, 9}) {
      BracketRequest request;
      request.grid = BracketRequest::Grid{stops, count};
      measure(bench, all, fmt::format("grid of {:g} stops", stops),
              fmt::format("hdr shoot --stops {:g} --count {}", stops, count), request);
    }
  }
}

}  // namespace hdr::bench
