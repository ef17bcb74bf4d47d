#include "capture/shoot.h"

#include <fmt/format.h>

#include "capture/develop.h"
#include "tools/hdr/options.h"
#include "tools/hdr/shots_output.h"

namespace hdr::tools {

std::function<int(Run&)> declare_shoot(CLI::App& app) {
  struct Options {
    std::string camera, times, output, format = "jpg";
    int quality = 95;
  };
  auto options = std::make_shared<Options>();
  app.add_option("--camera", options->camera, "virtual:SCENE.exr")->required();
  app.add_option("--times", options->times, "seconds, e.g. 1/250,1/60,1/15")->required();
  app.add_option("-o,--output", options->output, "folder for the shots and bracket.json")->required();
  app.add_option("--format", options->format, "of the shots")
      ->check(CLI::IsMember({"jpg", "png", "tif"}))
      ->capture_default_str();
  app.add_option("--quality", options->quality, "of JPEG")->check(CLI::Range(1, 100))->capture_default_str();
  return [options](Run& run) {
    const std::vector<double> times = times_from_text(options->times, "--times");
    const auto camera = run.stage("open", [&] { return open_camera(options->camera); });
    ShotsOutput output(options->output);
    const Take take = run.stage("shoot", [&](const Progress& progress) {
      ShootOptions shooting;
      shooting.progress = [&](std::size_t done, std::size_t of) {
        progress.update(static_cast<double>(done) / static_cast<double>(of));
      };
      BracketRequest request;
      request.times = times;
      return shoot(*camera, request, shooting);
    });
    const Capabilities limits = camera->capabilities();
    Json seconds = Json::array();
    run.stage("write", [&] {
      for (const Frame& frame : take.frames) {
        Photo photo = develop(frame, {limits.f_number, limits.iso});
        photo.lossy = options->format == "jpg";
        output.write(photo, {frame.requested.seconds, frame.verified, frame.sequence}, options->format,
                     options->quality);
        seconds.push_back(*photo.exposure.seconds);
      }
    });
    run.answer["frames"] = output.rows();
    run.answer["plan"] = {{"times", times}, {"reason", "the times were given"}};
    output.write_json(
        {{"files", output.names()}, {"times", seconds}, {"camera", options->camera}, {"frames", output.rows()}});
    run.say(fmt::format("{} shots in {}", take.frames.size(), options->output));
    return 0;
  };
}

}  // namespace hdr::tools
