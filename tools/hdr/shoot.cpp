// A bracket from a camera.
#include "capture/shoot.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "libhdr/io/exposure_list.h"
#include "libhdr/io/output_file.h"
#include "libhdr/response/response.h"
#include "tools/hdr/interrupt.h"
#include "tools/hdr/live_view.h"
#include "tools/hdr/options.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/shots_output.h"

namespace hdr::tools {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::string camera, times, output, format = "auto", response;
  std::optional<double> stops, mains, deadline, preview;
  std::optional<int> count;
  bool automatic = false, raw = false;
  int quality = 95;
};

void declare_options(CLI::App& app, Options& o) {
  app.add_option(
      "--camera", o.camera,
      "v4l2:/dev/video0, libcamera:ID or virtual:SCENE.exr, as `hdr cameras` lists them (default: the first)");
  auto* times = app.add_option("--times", o.times, "seconds, e.g. 1/250,1/60,1/15");
  auto* stops = app.add_option("--stops", o.stops, "a grid about the scene's middle: stops between shots")
                    ->check(CLI::PositiveNumber);
  auto* count = app.add_option("--count", o.count, "shots of that grid")->check(CLI::Range(1, 99));
  auto* automatic =
      app.add_flag("--auto", o.automatic, "as few shots as the scene needs, found by probing it (the default)");
  stops->needs(count)->excludes(times)->excludes(automatic);
  count->needs(stops);
  times->excludes(automatic);
  app.add_option("-o,--output", o.output, "folder for the shots and bracket.json");
  app.add_option("--format", o.format, "of the shots; auto: dng of raw frames, the camera's own jpg, else png")
      ->check(CLI::IsMember({"auto", "jpg", "png", "tif", "dng"}))
      ->capture_default_str();
  app.add_flag("--raw", o.raw, "raw frames or none (default: raw where the camera offers it)");
  app.add_option("--quality", o.quality, "of JPEG that is made here")->check(CLI::Range(1, 100))->capture_default_str();
  app.add_option("--response", o.response,
                 "the camera's, if known: a response file, srgb, linear, gamma:2.2; --auto then needs a shot less, and "
                 "bracket.json tells merge");
  app.add_option("--mains", o.mains,
                 "hertz of the lamps' power, 50 or 60: exposures that are chosen here are multiples of their flicker; "
                 "of --times, those that are none are kept, with a warning")
      ->check(CLI::IsMember({50, 60}));
  app.add_option("--deadline", o.deadline, "seconds until the whole bracket must be there")->check(CLI::PositiveNumber);
  app.add_option("--preview", o.preview, "live view before: until Enter is pressed, or for so many seconds")
      ->expected(0, 1)
      ->default_str("0")
      ->check(CLI::NonNegativeNumber);
}

std::unique_ptr<CameraDevice> opened(Run& run, const Options& o) {
  std::string uri = o.camera;
  if (uri.empty()) {
    uri = list_cameras().front().uri;  // the virtual one is always there, and the last
    const bool is_virtual = uri.rfind("virtual:", 0) == 0;
    run.say(is_virtual ? "no camera is connected: the virtual one stands in; `hdr cameras` lists what there is"
                       : "camera: " + uri);
  }
  run.answer["camera"] = uri;
  return open_camera(uri);
}

/// Raw frames where the person or the formats say so.
FrameFormat configured(CameraDevice& camera, const Options& o) {
  const std::vector<FrameFormat> formats = camera.capabilities().formats;
  const auto raw =
      std::find_if(formats.begin(), formats.end(), [](const FrameFormat& f) { return is_bayer(f.pixels); });
  if ((o.raw || o.format == "dng") && raw == formats.end()) {
    throw CameraError(CameraError::Kind::kNotSupported,
                      fmt::format("{}: has no raw frames; leave out {}", camera.capabilities().uri,
                                  o.raw ? "--raw" : "--format dng"));
  }
  if (o.format == "jpg" && !o.raw) {  // its own, or what 8 bits can hold
    for (const PixelFormat wanted :
         {PixelFormat::kMjpeg, PixelFormat::kYuyv, PixelFormat::kRgb8, PixelFormat::kGrey8}) {
      for (const FrameFormat& format : formats) {
        if (format.pixels == wanted) return camera.configure({wanted, std::nullopt, false});
      }
    }
  }
  Configuration configuration;
  if (raw != formats.end()) configuration.pixels = raw->pixels;
  return camera.configure(configuration);
}

BracketRequest request_of(const Options& o, const FrameFormat& format) {
  BracketRequest request;
  if (!o.times.empty()) {
    request.times = times_from_text(o.times, "--times");
    for (const double t : request.times) {
      if (!(t > 0 && std::isfinite(t))) throw Error(fmt::format("--times: {} is not a positive number of seconds", t));
    }
  }
  if (o.stops) request.grid = BracketRequest::Grid{*o.stops, *o.count};
  request.response_known = is_linear(format) || !o.response.empty();
  request.mains_hz = o.mains;
  return request;
}

/// Told by every frame: whether to go on.
void check_time(const CameraDevice& camera, Clock::time_point end) {
  Interrupt::check();
  if (camera.now() <= end) return;
  throw CameraError(CameraError::Kind::kTimeout,
                    camera.capabilities().uri + ": the bracket was not there at the --deadline; nothing was written");
}

bool enter_is_pressed() {
  constexpr int kMilliseconds = 20;
  pollfd in{STDIN_FILENO, POLLIN, 0};
  if (poll(&in, 1, kMilliseconds) <= 0) return false;
  char ignored[256];
  return read(STDIN_FILENO, ignored, sizeof ignored) >= 0;
}

/// Frames one after the other, exposed so that what is seen is neither black nor white.
void preview(CameraDevice& camera, LiveView& view, const Options& o) {
  const bool until_enter = *o.preview == 0;
  if (until_enter && !isatty(STDIN_FILENO)) {
    throw Error("--preview: there is no terminal to press Enter on; give seconds, as in --preview 5");
  }
  const Capabilities limits = camera.capabilities();
  ExposureSetting setting{limits.seconds.snap(1.0 / 60), limits.gain.min};
  camera.start(setting);
  const auto start = camera.now();
  const auto enough = [&] {
    return until_enter ? enter_is_pressed() : std::chrono::duration<double>(camera.now() - start).count() > *o.preview;
  };
  int age = 0;
  while (!enough()) {
    Interrupt::check();
    const auto patience = std::chrono::duration<double>(setting.seconds + 5);
    const Frame frame = camera.next_frame(camera.now() + std::chrono::duration_cast<Clock::duration>(patience));
    view.show(frame);
    constexpr int kObeyed = 6;  // frames after which a setting has reached the picture, in most devices
    if (++age < kObeyed) continue;
    const Appearance seen = appearance_of(frame);
    const double factor = seen.clipped() > 0.05 ? 0.5 : seen.dark() > 0.5 ? 2 : 1;
    if (factor == 1) continue;
    setting.seconds = limits.seconds.snap(setting.seconds * factor);
    camera.set(setting);
    age = 0;
  }
  camera.stop();
}

Json plan_row(const Plan& plan) {
  Json times = Json::array(), shots = Json::array();
  for (const PlannedShot& shot : plan.shots) {
    times.push_back(shot.setting.seconds);
    shots.push_back({{"seconds", shot.setting.seconds}, {"gain", shot.setting.gain}, {"reason", shot.reason}});
  }
  return {{"times", std::move(times)},
          {"shots", std::move(shots)},
          {"notes", plan.notes},
          {"bright_end_lost", plan.bright_end_lost},
          {"dark_end_lost", plan.dark_end_lost}};
}

/// "response" of bracket.json: what merge need not fit. A response file comes along.
std::optional<std::string> noted_response(const Options& o, const FrameFormat& format, const ShotsOutput& output) {
  constexpr const char* kFile = "response.json";
  if (is_linear(format)) return "linear";
  if (o.response.empty()) return std::nullopt;
  if (response_from_name(o.response, format.pixels == PixelFormat::kMjpeg ? 8 : bits_of(format.pixels)))
    return o.response;
  write_text(output.place(kFile), read_text(o.response));
  return kFile;
}

Take take_bracket(Run& run, CameraDevice& camera, const BracketRequest& request, LiveView& view, const Options& o) {
  const auto far = std::chrono::hours(24);
  const auto patience = o.deadline
                            ? std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(*o.deadline))
                            : Clock::duration(far);
  const auto end = camera.now() + patience;
  ShootOptions shooting;
  shooting.frame_deadline = std::min(shooting.frame_deadline, std::chrono::ceil<std::chrono::milliseconds>(patience));
  const auto shoot_with = [&] { return shoot(camera, request, shooting); };
  if (view.on()) {  // a bar would be drawn over it
    shooting.on_frame = [&](const Frame& frame) {
      check_time(camera, end);
      view.show(frame);
    };
    return run.clock.run("shoot", shoot_with);
  }
  shooting.on_frame = [&](const Frame&) { check_time(camera, end); };
  return run.stage("shoot", [&](const Progress& progress) {
    shooting.progress = [&](std::size_t done, std::size_t of) {
      progress.update(static_cast<double>(done) / static_cast<double>(of));
    };
    return shoot_with();
  });
}

/// Writes the shots; bracket.json's rows say what EXIF cannot.
void write_bracket(Run& run, const CameraDevice& camera, const FrameFormat& format, const Take& take,
                   const Options& o) {
  ShotsOutput output(o.output);
  const Capabilities limits = camera.capabilities();
  // EXIF has no gain but the ISO speed's: of a camera that does not know its own, 100 stands for the least gain.
  const bool has_gain = limits.gain.max > limits.gain.min;
  const DevelopOptions optics{limits.f_number, limits.iso ? limits.iso
                                               : has_gain ? std::optional(100.0)
                                                          : std::nullopt};
  Json seconds = Json::array();
  run.stage("write", [&] {
    for (const Frame& frame : take.frames) {
      Interrupt::check();
      output.write(frame, optics, limits.name, o.format, o.quality);
      seconds.push_back(*exposure_of(frame, optics).seconds);
    }
    Json bracket = {{"files", output.names()}, {"times", seconds}, {"camera", limits.uri}, {"format", to_text(format)}};
    if (const auto response = noted_response(o, format, output)) bracket["response"] = *response;
    bracket["frames"] = output.rows();
    for (Json& row : bracket["frames"]) row["path"] = Path(row["path"].get<std::string>()).filename().string();
    Interrupt::check();
    output.commit(bracket);
  });
  run.answer["frames"] = output.rows();
}

int work(Run& run, const Options& o) {
  if (o.output.empty() && !o.preview) throw CLI::RequiredError("-o");
  const Interrupt interrupt;
  const auto camera = run.stage("open", [&] { return opened(run, o); });
  const FrameFormat format = configured(*camera, o);
  LiveView view(run.quiet || run.json);
  if (o.preview) {
    preview(*camera, view, o);
    view.clear();
    if (o.output.empty()) return 0;
  }
  const Take take = take_bracket(run, *camera, request_of(o, format), view, o);
  view.clear();
  for (const std::string& warning : take.warnings) run.warn(warning);
  for (const std::string& note : take.plan.notes) run.warn(note);
  write_bracket(run, *camera, format, take, o);
  run.answer["plan"] = plan_row(take.plan);
  run.answer["format"] = to_text(format);
  run.answer["latency_frames"] = take.latency;
  run.answer["device_seconds"] = {
      {"prepare", take.prepare_seconds}, {"probe", take.probe_seconds}, {"bracket", take.bracket_seconds}};
  for (const Json& row : run.answer["frames"]) {
    run.say(fmt::format("{}: {}, verified by {}", Path(row["path"].get<std::string>()).filename().string(),
                        text_from_seconds(row["seconds"]), row["verified"].get<std::string>()));
  }
  run.say(fmt::format("{} shots of {} in {}", take.frames.size(), to_text(format), o.output));
  return 0;
}

}  // namespace

std::function<int(Run&)> declare_shoot(CLI::App& app) {
  auto options = std::make_shared<Options>();
  declare_options(app, *options);
  return [options](Run& run) { return work(run, *options); };
}

}  // namespace hdr::tools
