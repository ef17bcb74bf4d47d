// Photographs a scene whose light is known, and writes the truth beside the shots.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "capture/virtual/virtual_camera.h"
#include "libhdr/core/error.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/filter/resize.h"
#include "libhdr/probe/photograph.h"
#include "libhdr/probe/photographer.h"
#include "libhdr/probe/test_chart.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/probe_input.h"
#include "tools/hdr/shots_output.h"

namespace hdr::tools {
namespace {

struct Options {
  std::string scene, output, times, size, rotate = "0,0,0", response = "srgb", format = "jpg";
  std::optional<double> fov, distance, ball_radius;
  std::string ball_at, reflectance;
  std::optional<double> photographer;
  bool ball = false, test_chart = false;
  double level = 0.18, full_well = 30000, read_noise = 5, shift = 0, tilt = 0;
  int depth = 8, quality = 95;
  std::uint64_t seed = 1;
};

void declare_options(CLI::App& app, Options& o) {
  app.add_option("scene", o.scene, "a radiance map: a picture, or a lat-long with --fov or --ball");
  app.add_option("-o,--output", o.output,
                 "folder for the shots, bracket.json and truth.exr; with --test-chart a picture")
      ->required();
  app.add_option("--times", o.times, "seconds, e.g. 1/1000,1/250,1/60");
  app.add_flag("--test-chart", o.test_chart,
               "no scene and no shots: writes a lat-long whose colours and labels say each direction (--size's width)");
  app.add_option("--size", o.size, "of the shots, WxH (default: the scene's, 1500x1000 with --fov or --ball)");
  app.add_option("--fov", o.fov, "look into a lat-long through a lens of this horizontal field, degrees");
  app.add_option("--rotate", o.rotate, "turns the scene: X,Y,Z degrees")->capture_default_str();
  app.add_flag("--ball", o.ball, "a mirror ball standing in the lat-long");
  app.add_option("--ball-radius", o.ball_radius, "of its outline, pixels (default: 40 % of the height)");
  app.add_option("--distance", o.distance, "camera to the ball's centre, in ball radii (default: far)");
  app.add_option("--ball-at", o.ball_at,
                 "X,Y: its outline's centre, pixels; near balls beside the middle are ellipses (default: the middle)");
  app.add_option("--reflectance", o.reflectance,
                 "R,G,B: of the ball, head-on; more towards the rim (default: 1,1,1, a perfect mirror)");
  app.add_option("--photographer", o.photographer,
                 "a dark figure of this half-width, degrees, stands behind the camera (default: nobody)");
  app.add_option("--response", o.response, "film, srgb, linear, gamma:2.2 or a response file")->capture_default_str();
  app.add_option("--level", o.level, "the median pixel at the middle time, as a share of full well")
      ->capture_default_str();
  app.add_option("--format", o.format, "of the shots")
      ->check(CLI::IsMember({"jpg", "png", "tif"}))
      ->capture_default_str();
  app.add_option("--depth", o.depth, "bits a channel")->check(CLI::IsMember({8, 16}))->capture_default_str();
  app.add_option("--quality", o.quality, "of JPEG")->check(CLI::Range(1, 100))->capture_default_str();
  app.add_option("--full-well", o.full_well, "electrons at the largest code")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--read-noise", o.read_noise, "electrons")->check(CLI::NonNegativeNumber)->capture_default_str();
  app.add_option("--shift", o.shift, "hand shake: up to this many pixels each way")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--tilt", o.tilt, "hand shake: up to this many degrees about the lens axis")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--seed", o.seed, "of noise and shake")->capture_default_str();
}

Size shot_size(const Options& o, Size scene) {
  if (!o.size.empty()) return size_from_text(o.size, "--size");
  return o.ball || o.fov ? Size{1500, 1000} : scene;
}

MirrorBall ball_of(const Options& o, Size size) {
  MirrorBall ball;
  ball.disc = {0.5 * size.width, 0.5 * size.height, o.ball_radius.value_or(0.4 * std::min(size.width, size.height))};
  if (!(ball.disc.r > 0)) throw Error("--ball-radius: give a positive number of pixels");
  if (o.distance) ball.distance = *o.distance;
  if (!(ball.distance > 1)) throw Error("--distance: the camera must be outside of the ball, more than 1 radius away");
  if (!o.ball_at.empty()) {
    const Vec2 place = vec2_from_text(o.ball_at, "--ball-at");
    ball.disc.cx = place.x();
    ball.disc.cy = place.y();
    if (o.distance) ball.principal = Vec2(0.5 * size.width, 0.5 * size.height);
  }
  return ball;
}

/// The picture that the lens throws on the sensor, and the ball's place in it.
Image<float> sensor_image(const Options& o, const ReadMap& scene, Size size, std::optional<MirrorBall>& ball) {
  const Mat3 scene_from_camera = rotation_from_degrees(vec3_from_text(o.rotate, "--rotate")).transpose();
  if (o.ball || o.fov) {
    const Projection projection = projection_of_probe("", scene.map.projection, scene.map.size(), o.scene);
    if (!is_plain_latlong(projection)) {
      throw Error(o.scene + ": --ball and --fov need a lat-long scene; hdr unwrap makes one");
    }
  }
  if (o.ball) {
    ball = ball_of(o, size);
    const Rgb reflectance =
        o.reflectance.empty() ? Rgb::Ones() : Rgb(vec3_from_text(o.reflectance, "--reflectance").array());
    const Image<float> with_figure =
        o.photographer ? with_photographer(scene.map.rgb, *o.photographer, scene_from_camera) : Image<float>();
    return photograph_ball(o.photographer ? with_figure : scene.map.rgb, size, *ball, o.fov.value_or(35),
                           scene_from_camera, reflectance);
  }
  if (o.fov) {
    if (!(*o.fov > 0 && *o.fov < 180)) throw Error("--fov: give degrees between 0 and 180");
    return photograph_view(scene.map.rgb, size, *o.fov, scene_from_camera);
  }
  if (size == scene.map.size()) return scene.map.rgb.clone();
  return resize(scene.map.rgb, size);
}

/// The labels that cameras write: third stops of the standard series.
double nominal_time(double seconds) {
  static constexpr double kLabels[] = {
      1.0 / 8000, 1.0 / 6400, 1.0 / 5000, 1.0 / 4000, 1.0 / 3200, 1.0 / 2500, 1.0 / 2000, 1.0 / 1600,
      1.0 / 1250, 1.0 / 1000, 1.0 / 800,  1.0 / 640,  1.0 / 500,  1.0 / 400,  1.0 / 320,  1.0 / 250,
      1.0 / 200,  1.0 / 160,  1.0 / 125,  1.0 / 100,  1.0 / 80,   1.0 / 60,   1.0 / 50,   1.0 / 40,
      1.0 / 30,   1.0 / 25,   1.0 / 20,   1.0 / 15,   1.0 / 13,   1.0 / 10,   1.0 / 8,    1.0 / 6,
      1.0 / 5,    1.0 / 4,    0.3,        0.4,        0.5,        0.6,        0.8,        1,
      1.3,        1.6,        2,          2.5,        3.2,        4,          5,          6,
      8,          10,         13,         15,         20,         25,         30};
  return *std::min_element(std::begin(kLabels), std::end(kLabels), [seconds](double a, double b) {
    return std::abs(std::log(a / seconds)) < std::abs(std::log(b / seconds));
  });
}

/// Shot k's hand shake: a turn about the picture's middle and a shift; the middle exposure stays.
Mat3 shake_of(const Options& o, Size size, std::size_t shot) {
  Random random(o.seed, 0x5a4e, shot);
  const double angle = o.tilt * kDegree * (2 * random.uniform() - 1);
  const Vec2 shift(o.shift * (2 * random.uniform() - 1), o.shift * (2 * random.uniform() - 1));
  const Vec2 middle(0.5 * (size.width - 1), 0.5 * (size.height - 1));
  Mat3 m = Mat3::Identity();
  m.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(angle).toRotationMatrix();
  m.topRightCorner<2, 1>() = middle - m.topLeftCorner<2, 2>() * middle + shift;
  return m;
}

Sensor sensor_of(const Options& o) {
  if (!(o.level > 0)) throw Error("--level: give a positive share of full well, e.g. 0.18");
  Sensor sensor;
  const auto response = known_response(o.response, o.depth);
  if (!response) throw Error("--response: film, srgb, linear, gamma:2.2 or a response file");
  sensor.response = *response;
  sensor.noise = {o.full_well, o.read_noise};
  return sensor;
}

/// g as 3 x 256 whatever the depth, at the centres of 8-bit codes.
Json curve_of(const Response& response) {
  Json g = Json::array();
  for (int c = 0; c < 3; ++c) {
    Json channel = Json::array();
    for (int z = 0; z < 256; ++z) {
      channel.push_back(response.ln_exposure(c, z * ((1 << response.bits) - 1) / 255.0));
    }
    g.push_back(std::move(channel));
  }
  return g;
}

Json affine(const Mat3& m) {
  return {{m(0, 0), m(0, 1), m(0, 2)}, {m(1, 0), m(1, 1), m(1, 2)}};
}

std::vector<double> valid_times(const Options& o) {
  std::vector<double> times = times_from_text(o.times, "--times");
  for (const double t : times) {
    if (!(t > 0) || !std::isfinite(t)) throw Error(fmt::format("--times: {} is not a positive number of seconds", t));
  }
  return times;
}

/// A lat-long to unwrap into others' conventions: what it then shows proves them.
int write_test_chart(Run& run, const Options& o) {
  const int width = o.size.empty() ? 2048 : size_from_text(o.size, "--size").width;
  if (width < 64) throw Error("--size: a test chart needs 64 pixels across; give WIDTHxHEIGHT");
  RadianceMap chart;
  chart.rgb = run.stage("chart", [&] { return test_chart(width); });
  chart.projection = LatLong::kName;
  Path output = o.output;
  if (!output.has_extension()) {  // a folder, as for shots
    std::filesystem::create_directories(output);
    output /= "test-chart.exr";
  }
  run.stage("write", [&] { write_map(output, chart, provenance_of(run, Path{})); });
  run.say("wrote " + output.string());
  return 0;
}

int simulate(Run& run, const Options& o) {
  if (o.test_chart) return write_test_chart(run, o);
  if (o.scene.empty()) throw CLI::RequiredError("scene");
  if (o.times.empty()) throw CLI::RequiredError("--times");
  const std::vector<double> times = valid_times(o);
  Sensor sensor = sensor_of(o);
  const Exposure optics{std::nullopt, 8.0, 100.0, 0};
  if (o.depth == 16 && o.format == "jpg") throw Error("--depth 16: JPEG has 8 bits; add --format png or tif");

  const ReadMap scene = run.stage("read", [&] { return read_map(o.scene); });
  for (const std::string& warning : scene.warnings) run.warn(warning);
  const Size size = shot_size(o, scene.map.size());
  std::optional<MirrorBall> ball;
  RadianceMap truth;
  truth.rgb = run.stage("scene", [&] { return sensor_image(o, scene, size, ball); });
  if (ball) truth.projection = text_from_projection(*ball);

  std::vector<double> sorted = times;
  std::sort(sorted.begin(), sorted.end());
  Exposure middle = optics;
  middle.seconds = sorted[(sorted.size() - 1) / 2];
  sensor.sensitivity = metered_sensitivity(truth.rgb, middle, o.level);
  const double k = sensor.sensitivity * *middle.relative() / *middle.seconds;

  // A camera writes its lens into EXIF. A ball seen from afar, all rays side by side, was photographed by none.
  std::optional<double> fov = o.ball ? std::nullopt : o.fov;
  if (ball && std::isfinite(ball->distance)) fov = fov_of_camera(*ball, size.width, 0);
  ShotsOutput output(o.output);
  Json transforms = Json::array(), nominal = Json::array();
  run.stage("shots", [&](const Progress& progress) {
    for (std::size_t shot = 0; shot < times.size(); ++shot) {
      const Mat3 scene_from_photo = times[shot] == *middle.seconds ? Mat3::Identity() : shake_of(o, size, shot);
      Exposure exposure = optics;
      exposure.seconds = times[shot];
      const std::uint64_t seed = hash64(o.seed) + shot;
      Photo photo = scene_from_photo.isIdentity(0) ? expose(truth.rgb, exposure, sensor, seed)
                                                   : expose(shake(truth.rgb, scene_from_photo), exposure, sensor, seed);
      photo.lossy = o.format == "jpg";
      output.write(photo, {times[shot], Verified::kMetadata, static_cast<std::uint32_t>(shot)}, o.format, o.quality,
                   fov);
      transforms.push_back(affine(scene_from_photo));
      nominal.push_back(nominal_time(times[shot]));
      progress.update(static_cast<double>(shot + 1) / static_cast<double>(times.size()));
    }
  });
  run.stage("write", [&] {
    write_map(output.place("truth.exr"), truth, provenance_of(run, Path(o.scene)), {SampleType::kFloat, "zip"});
  });
  Json json = {{"files", output.names()},
               {"times_true", times},
               {"times_nominal", nominal},
               {"g", curve_of(sensor.response)},
               {"k", k},
               {"transforms", transforms}};
  json["ball"] = nullptr;
  if (ball) {
    json["ball"] = {{"cx", ball->disc.cx}, {"cy", ball->disc.cy}, {"r", ball->disc.r}};
    json["ball"]["distance"] = std::isfinite(ball->distance) ? Json(ball->distance) : Json(nullptr);
    json["ball"]["fov"] = fov_of_camera(*ball, size.width, o.fov.value_or(35));
  }
  output.commit(json);
  run.answer["frames"] = output.rows();
  run.answer["ball"] = json["ball"];
  run.say(fmt::format("{} shots of {}x{} in {}", times.size(), size.width, size.height, o.output));
  return 0;
}

}  // namespace

std::function<int(Run&)> declare_simulate(CLI::App& app) {
  auto options = std::make_shared<Options>();
  declare_options(app, *options);
  return [options](Run& run) { return simulate(run, *options); };
}

}  // namespace hdr::tools
