#include "tools/hdr/render_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/radiance.h"
#include "libhdr/filter/tonemap.h"
#include "libhdr/io/write_layers.h"

namespace hdr::tools {
namespace {

const std::vector<std::string> kLayers{"ao", "normal", "albedo", "depth", "variance", "stddev"};

std::string extension_of(const std::string& path) {
  std::string extension = Path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

Image<float> one_channel(View<const float> from, float (*of)(float)) {
  Image<float> to(from.size(), 1);
  for (int y = 0; y < from.height(); ++y)
    for (int x = 0; x < from.width(); ++x) to(x, y) = of(from(x, y));
  return to;
}

// Colours as they are, without what alpha multiplied into them: as PNG wants them.
Image<float> unmultiplied(const RadianceMap& picture) {
  Image<float> rgb = picture.rgb.clone();
  for (int y = 0; y < rgb.height(); ++y)
    for (int x = 0; x < rgb.width(); ++x)
      for (int c = 0; c < 3; ++c) rgb(x, y, c) = picture.alpha(x, y) > 0 ? rgb(x, y, c) / picture.alpha(x, y) : 0.0f;
  return rgb;
}

}  // namespace

void RenderOutput::declare(CLI::App& app) {
  app.add_option("-o,--output", path,
                 "the picture: .exr (RGBA: alpha is coverage), .hdr, .pfm, or .png .jpg to look at")
      ->required();
  app.add_option("--layers", layers, "more layers of an EXR: ao, normal, albedo, depth, variance, stddev")
      ->delimiter(',')
      ->check(CLI::IsMember(kLayers));
  app.add_flag("--transparent", transparent, "no backdrop: what shows nothing of the scene is black and transparent");
  app.add_option("--stops", stops, "exposure of .png and .jpg (default: metered, log-average to 18 % grey)");
  write.declare(app);
}

bool RenderOutput::is_picture() const {
  const std::string extension = extension_of(path);
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

bool RenderOutput::wants(const std::string& layer) const {
  return std::find(layers.begin(), layers.end(), layer) != layers.end();
}

void RenderOutput::check() const {
  if (!layers.empty() && extension_of(path) != ".exr")
    throw Error(path + ": --layers needs an .exr: no other format has layers");
  if (stops && !is_picture()) throw Error(path + ": --stops is for .png and .jpg; maps keep their radiance");
}

void RenderOutput::save(Run& run, const Rendering& rendering, View<const float> openness,
                        const Provenance& provenance) const {
  if (is_picture()) {
    const double exposure = stops ? *stops : metered_stops(rendering.picture.rgb);
    run.answer["stops"] = exposure;
    run.say(fmt::format("shown at {:+.2f} stops{}", exposure, stops ? "" : ": log-average is 18 % grey"));
    run.stage("write", [&] {
      if (!transparent) return write_picture(path, tonemap(rendering.picture.rgb, exposure));
      write_picture(path, tonemap(unmultiplied(rendering.picture), exposure, rendering.picture.alpha));
    });
    run.say("wrote " + path);
    return;
  }
  run.stage("write", [&] {
    if (layers.empty()) return write_map(path, rendering.picture, provenance, write.options());
    const Image<float> openings = openness.empty() ? Image<float>() : one_channel(openness, [](float v) { return v; });
    const Image<float> deviation = one_channel(rendering.variance, [](float v) { return std::sqrt(v); });
    std::vector<Layer> planes;
    for (const std::string& layer : layers) {
      if (layer == "ao") planes.push_back({{"ao"}, openings});
      if (layer == "normal") planes.push_back({{"normal.X", "normal.Y", "normal.Z"}, rendering.normal});
      if (layer == "albedo") planes.push_back({{"albedo.R", "albedo.G", "albedo.B"}, rendering.albedo});
      if (layer == "depth") planes.push_back({{"depth"}, rendering.depth});
      if (layer == "variance") planes.push_back({{"variance"}, rendering.variance});
      if (layer == "stddev") planes.push_back({{"stddev"}, deviation});
    }
    write_layers(path, rendering.picture, planes, provenance, write.options());
  });
  run.say("wrote " + path);
}

}  // namespace hdr::tools
