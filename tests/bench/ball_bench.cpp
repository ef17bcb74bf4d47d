// How well find_ball places balls, and what else it takes for one: simulated photographs of balls and of other round
// things in maps from files. Prints a line a case and a count a kind.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>

#include "libhdr/align/align.h"
#include "libhdr/core/color.h"
#include "libhdr/core/median.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "libhdr/merge/merge.h"
#include "libhdr/probe/find_ball.h"
#include "libhdr/probe/photograph.h"
#include "libhdr/probe/photographer.h"
#include "libhdr/response/expose.h"
#include "tests/support/round_thing.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

Size frame{1000, 750};  // times --scale
double radius_scale = 1;
bool compressed = false;         // --jpeg
bool lens_known = false;         // --lens
std::filesystem::path pictures;  // --pictures: where photographs whose ball was not placed well are written

struct Place {
  std::string name;
  Image<float> map;
};

Vec3 random_turn(Random& random) {
  return {16 * random.uniform() - 8, 360 * random.uniform(), 6 * random.uniform() - 3};
}

/// Of green, above 0: what a picture's brightness is measured by.
double median_of_green(const Image<float>& picture, int step) {
  std::vector<float> values;
  for (int y = 0; y < picture.height(); y += step) {
    for (int x = 0; x < picture.width(); x += step) values.push_back(picture(x, y, 1));
  }
  return std::max(1e-9, static_cast<double>(median_of(values)));
}

void add_noise(Image<float>& picture, double share, std::uint64_t seed) {
  const double floor = 0.02 * median_of_green(picture, 4);
  for (int y = 0; y < picture.height(); ++y) {
    Random random(seed, static_cast<std::uint64_t>(y));
    for (std::size_t k = 0; k < picture.row_samples(); ++k) {
      float& value = picture.row(y)[k];
      value =
          std::max(0.0f, value + static_cast<float>(share * (static_cast<double>(value) + floor) * random.normal()));
    }
  }
}

/// What becomes of `scene` on its way through a camera's compressed bracket and a merge.
Image<float> merged_from_jpegs(const Image<float>& scene, std::uint64_t seed) {
  constexpr int kShots = 5;
  Sensor sensor{srgb_response(8)};
  sensor.sensitivity = 0.18 / median_of_green(scene, 4);
  const test::ScratchDir scratch;
  Bracket bracket;
  for (int k = 0; k < kShots; ++k) {
    Exposure exposure;
    exposure.seconds = std::exp2(2 * (k - kShots / 2));
    const auto path = scratch / fmt::format("{}.jpg", k);
    write_photo(path, expose(scene, exposure, sensor, kShots * seed + static_cast<std::uint64_t>(k)));
    bracket.shots.push_back(read_photo(path));
    bracket.input_order.push_back(k);
  }
  return std::move(merge(bracket, no_alignment(bracket), sensor.response).map.rgb);
}

/// Within what a finder may be asked for: half a pixel in centre and radius.
bool ball_case(const Place& place, std::uint64_t seed, bool tell) {
  Random random(seed, 21);
  const double r = radius_scale * (100 + 230 * random.uniform()),
               d = std::exp(std::log(5.0) + random.uniform() * std::log(20.0));
  MirrorBall ball{{0, 0, r}, d};
  const double room_x = 0.5 * frame.width - r - 8, room_y = 0.5 * frame.height - r - 8;
  ball.disc.cx = 0.5 * frame.width + room_x * (2 * random.uniform() - 1) * 0.7;
  ball.disc.cy = 0.5 * frame.height + room_y * (2 * random.uniform() - 1) * 0.7;
  if (random.uniform() < 0.3)
    ball.distance = std::numeric_limits<double>::infinity();
  else
    ball.principal = Vec2(0.5 * frame.width, 0.5 * frame.height);
  const double chrome = random.uniform() < 0.5 ? 1 : 0.5 + 0.4 * random.uniform();
  const Mat3 turn = rotation_from_degrees(random_turn(random));
  constexpr double kFarField = 35;  // degrees, of a far camera's backdrop
  const Image<float> scene = with_photographer(place.map, 8, turn);
  Image<float> picture = photograph_ball(scene, frame, ball, kFarField, turn, Rgb::Constant(chrome));
  if (compressed) {
    picture = merged_from_jpegs(picture, seed);
  } else {
    add_noise(picture, 0.002 + 0.008 * random.uniform(), seed);
  }
  FindBallOptions known;
  if (lens_known) known.fov_degrees = fov_of_camera(ball, frame.width, kFarField);
  const auto found = find_ball(picture, known);
  const double centre = found ? std::hypot(found->ball.disc.cx - ball.disc.cx, found->ball.disc.cy - ball.disc.cy) : 99;
  const double radius = found ? found->ball.disc.r - r : 99;
  if (tell)
    fmt::print("ball {:10} seed {:3}: r {:5.1f} D {:6.1f} {:.2f}: {} centre {:.2f} radius {:+.2f}\n", place.name, seed,
               r, ball.distance, chrome, found ? "found" : "LOST", centre, radius);
  const bool good = centre <= 0.5 && std::abs(radius) <= 0.5;
  if (!good && !pictures.empty()) {
    RadianceMap map;
    map.rgb = std::move(picture);
    write_map(pictures / fmt::format("{}_{}.exr", place.name, seed), map);
  }
  return good;
}

using Radiance = std::function<double(const Vec2&)>;

/// Other round things: radiance on the unit disc, y down, against the picture's median of 1.
std::map<std::string, Radiance> round_things(Random& random, const Place& place) {
  const double a = random.uniform(), phase = 2 * kPi * random.uniform(), bright = 2 + 8 * random.uniform();
  const auto look = [&place](const Mat3& turn, double half_field, const Vec2& p, double median) {
    const double t = std::tan(half_field * kDegree);
    const Vec3 d = turn * Vec3(-p.x() * t, -p.y() * t, 1).normalized();
    const Vec2 uv = latlong_from_dir(d);
    const double x = uv.x() * place.map.width() - 0.5, y = uv.y() * place.map.height() - 0.5;
    const int left = static_cast<int>(std::floor(x)), top = std::clamp(static_cast<int>(y), 0, place.map.height() - 2);
    const double fx = x - left, fy = std::clamp(y - top, 0.0, 1.0);
    const auto at = [&](int i, int j) {
      const float* q = place.map.pixel((i + place.map.width()) % place.map.width(), j);
      return static_cast<double>(luminance(q[0], q[1], q[2]));
    };
    return ((1 - fy) * ((1 - fx) * at(left, top) + fx * at(left + 1, top)) +
            fy * ((1 - fx) * at(left, top + 1) + fx * at(left + 1, top + 1))) /
           median;
  };
  const double median = median_of_green(place.map, 3);
  const Mat3 turn = rotation_from_degrees(random_turn(random));
  const double half_field = 10 + 25 * random.uniform();
  std::vector<Vec3> lights;
  for (int k = 0; k < 3; ++k)
    lights.push_back(Vec3(2 * random.uniform() - 1, random.uniform(), random.uniform() - 0.2).normalized());
  std::vector<Vec3> waves;
  for (int k = 0; k < 10; ++k) {
    const double w = std::exp2(3 + 2.5 * random.uniform());
    waves.push_back(w * Vec3(random.normal(), random.normal(), random.normal()).normalized());
  }
  std::vector<std::array<double, 5>> bars;
  for (int k = 0; k < 14; ++k)
    bars.push_back({1.6 * random.uniform() - 0.8, 1.6 * random.uniform() - 0.8, 0.05 + 0.3 * random.uniform(),
                    0.03 + 0.12 * random.uniform(), random.uniform()});
  const auto texture = [waves](const Vec3& p) {
    double sum = 0;
    for (const Vec3& w : waves) sum += std::sin(w.dot(p) + 7 * w.x());
    return std::exp(0.35 * sum);
  };
  const auto shading = [lights, a](const Vec2& p) {
    const Vec3 n(p.x(), -p.y(), std::sqrt(std::max(0.0, 1 - p.squaredNorm())));
    double sum = 0.3 + 0.3 * a;
    for (const Vec3& l : lights) sum += std::max(0.0, n.dot(l));
    return sum;
  };
  const auto on_sphere = [](const Vec2& p) {
    return Vec3(p.x(), p.y(), std::sqrt(std::max(0.0, 1 - p.squaredNorm())));
  };
  std::map<std::string, Radiance> things;
  things["flat mirror"] = [=](const Vec2& p) { return look(turn, half_field, p, median); };
  things["sign"] = [=](const Vec2& p) {
    if (p.norm() > 0.88) return 0.25;
    for (const auto& b : bars)
      if (std::abs(p.x() - b[0]) < b[2] && std::abs(p.y() - b[1]) < b[3]) return 0.1 + 0.5 * b[4];
    return 2.0;
  };
  things["even lamp"] = [=](const Vec2& p) { return bright * (1 + 0.2 * a * p.x()); };
  things["milk glass"] = [=](const Vec2& p) {
    return bright * (0.3 + 0.7 * std::sqrt(1 - std::min(1.0, p.squaredNorm())));
  };
  things["plate"] = [=](const Vec2& p) {
    return (1.2 + 0.6 * std::sin((10 + 20 * a) * p.squaredNorm() + phase)) * (1 + 0.3 * a * p.x());
  };
  things["wheel"] = [=](const Vec2& p) {
    if (p.norm() > 0.8) return 0.1;
    return std::cos(9 * std::atan2(p.y(), p.x()) + phase) > 0.2 ? 1.5 : 0.3;
  };
  things["softbox"] = [=](const Vec2& p) {
    const Vec2 q(p.x() - 0.3 * a, p.y() + 0.2 * a);
    return bright * std::exp(-1.2 * q.squaredNorm()) * (1 + 0.01 * std::sin(40 * p.x()) * std::sin(40 * p.y()));
  };
  things["matt ball"] = [=](const Vec2& p) { return shading(p); };
  things["globe"] = [=](const Vec2& p) { return shading(p) * texture(on_sphere(p)); };
  things["porthole"] = [=](const Vec2& p) {
    const double angle = std::atan2(p.y(), p.x());
    if (p.norm() > 0.82) return 1.2 + 0.5 * std::cos(2 * angle + phase) + 0.6 * std::cos(20 * (p.norm() - 0.9));
    return look(turn, half_field, p, median);
  };
  things["clock"] = [=](const Vec2& p) {
    const double angle = std::atan2(p.y(), p.x()), tick = std::abs(std::remainder(angle, kPi / 6));
    if (p.norm() > 0.95) return 0.2;
    if (p.norm() > 0.78 && tick * p.norm() < 0.02) return 0.15;
    if (std::abs(std::remainder(angle - phase, 2 * kPi)) < 0.04 / std::max(0.05, p.norm()) && p.norm() < 0.7)
      return 0.1;
    return 1.8;
  };
  things["rug"] = [=](const Vec2& p) { return texture(Vec3(p.x(), p.y(), 0.3)); };
  return things;
}

Image<float> picture_of_thing(const Place& place, std::uint64_t seed, const std::string& kind) {
  Random random(seed, 22);
  Image<float> view =
      photograph_view(place.map, frame, 40 + 25 * random.uniform(), rotation_from_degrees(random_turn(random)));
  const double median = median_of_green(view, 4);
  const double r = radius_scale * (100 + 230 * random.uniform());
  const Disc disc{0.5 * frame.width + (0.5 * frame.width - r - 8) * (2 * random.uniform() - 1) * 0.7,
                  0.5 * frame.height + (0.5 * frame.height - r - 8) * (2 * random.uniform() - 1) * 0.7, r};
  const Radiance radiance = round_things(random, place).at(kind);
  test::paint_round(view, disc, [&](const Vec2& p) { return median * radiance(p); });
  add_noise(view, 0.002 + 0.008 * random.uniform(), seed);
  return view;
}

int run(int argc, char** argv) {
  std::string folder, only;
  int seeds = 4, first_seed = 1;
  bool tell = false;
  CLI::App app("balls found, and other round things taken for one");
  app.add_option("folder", folder, "lat-long maps (.hdr, .exr)")->required();
  app.add_option("--seeds", seeds, "cases a map (balls), a kind (other things)");
  app.add_option("--first-seed", first_seed);
  app.add_option("--only", only, "one kind");
  app.add_option("--scale", radius_scale, "pictures and balls so much larger");
  app.add_flag("--jpeg", compressed, "balls through five JPEG shots and a merge, instead of noise alone");
  app.add_flag("--lens", lens_known, "the camera's field is known, as from EXIF");
  app.add_option("--pictures", pictures, "folder for the photographs whose ball was not placed within half a pixel");
  app.add_flag("--tell", tell, "a line a case");
  CLI11_PARSE(app, argc, argv);
  frame = {static_cast<int>(frame.width * radius_scale), static_cast<int>(frame.height * radius_scale)};
  std::vector<Place> places;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".hdr" || extension == ".exr")
      places.push_back({entry.path().stem().string(), read_map(entry.path()).map.rgb.clone()});
  }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.name < b.name; });
  if (places.empty()) throw Error(folder + ": no maps");
  std::uint64_t seed = 1000 * static_cast<std::uint64_t>(first_seed);
  if (only.empty() || only == "ball") {
    int good = 0, all = 0;
    for (const Place& place : places) {
      for (int k = 0; k < seeds; ++k, ++all) good += ball_case(place, ++seed, tell);
    }
    fmt::print("balls within half a pixel: {} of {}\n", good, all);
  }
  Random random(1, 1);
  int taken_in_all = 0, all = 0;
  for (const auto& [kind, radiance] : round_things(random, places.front())) {
    if (!only.empty() && only != kind && only != "things") continue;
    int taken = 0;
    for (int k = 0; k < seeds; ++k, ++all) {
      const Place& place = places[++seed % places.size()];
      const auto found = find_ball(picture_of_thing(place, seed, kind));
      taken += found.has_value();
      if (tell && found)
        fmt::print("{} in {} seed {}: taken, {:.1f} {:.1f} r {:.1f} support {:.2f}\n", kind, place.name, seed,
                   found->ball.disc.cx, found->ball.disc.cy, found->ball.disc.r, found->support);
    }
    taken_in_all += taken;
    fmt::print("{:12} taken for balls: {} of {}\n", kind, taken, seeds);
  }
  fmt::print("other things taken for balls: {} of {}\n", taken_in_all, all);
  return 0;
}

}  // namespace
}  // namespace hdr

int main(int argc, char** argv) {
  try {
    return hdr::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
