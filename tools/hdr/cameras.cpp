// What is connected.
#include <fmt/format.h>

#include "capture/camera.h"
#include "libhdr/io/exposure_list.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {
namespace {

Json row_of(const Capabilities& camera) {
  Json formats = Json::array();
  for (const FrameFormat& format : camera.formats) formats.push_back(to_text(format));
  return {{"uri", camera.uri},
          {"name", camera.name},
          {"formats", std::move(formats)},
          {"exposure_seconds", {camera.seconds.min, camera.seconds.max}},
          {"gain", {camera.gain.min, camera.gain.max}},
          {"frame_seconds", camera.frame_seconds},
          {"manual_exposure", camera.manual_exposure},
          {"reports_exposure", camera.reports_exposure}};
}

void tell(const Run& run, const Capabilities& camera) {
  run.say(fmt::format("{}   {}", camera.uri, camera.name));
  if (camera.manual_exposure) {
    run.say(fmt::format(
        "  exposes for {} to {}, gain 1 to {:.4g}; {}", text_from_seconds(camera.seconds.min),
        text_from_seconds(camera.seconds.max), camera.gain.max / camera.gain.min,
        camera.reports_exposure ? "says with each frame how it was exposed" : "exposures are verified by brightness"));
  } else {
    run.say("  has no manual exposure: it cannot take a bracket");
  }
  for (const FrameFormat& format : camera.formats) run.say("  " + to_text(format));
}

}  // namespace

std::function<int(Run&)> declare_cameras(CLI::App&) {
  return [](Run& run) {
    Json rows = Json::array();
    for (const CameraName& camera : list_cameras()) {
      try {
        const Capabilities capabilities = open_camera(camera.uri)->capabilities();
        rows.push_back(row_of(capabilities));
        tell(run, capabilities);
      } catch (const Error& error) {  // one that is busy or forbidden is there all the same
        rows.push_back({{"uri", camera.uri}, {"name", camera.name}, {"error", error.what()}});
        run.say(fmt::format("{}   {}\n  {}", camera.uri, camera.name, error.what()));
      }
    }
    run.answer["cameras"] = std::move(rows);
    return 0;
  };
}

}  // namespace hdr::tools
