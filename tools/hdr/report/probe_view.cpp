#include "tools/hdr/report/probe_view.h"

#include <fmt/format.h>

#include <cmath>

#include "libhdr/light/prefilter.h"
#include "libhdr/light/sh.h"
#include "tools/hdr/report/assets.h"
#include "tools/hdr/report/embed.h"

namespace hdr::report {
namespace {

constexpr double kRoughness[] = {0.15, 0.3, 0.45, 0.6, 0.8, 1};
constexpr int kSamples = 128;  ///< of a lobe
constexpr Size kLevelSize{192, 96};
constexpr int kTableSize = 32;

Image<float> only_light(View<const float> latlong) {
  Image<float> light(latlong.size(), 3);
  for (int y = 0; y < latlong.height(); ++y) {
    for (int x = 0; x < latlong.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        const float value = latlong(x, y, c);
        light(x, y, c) = std::isfinite(value) && value > 0 ? value : 0;
      }
    }
  }
  return light;
}

/// The three matrices of [Ramamoorthi01] eq. 12, which are symmetric: by rows or by columns is the same.
std::string irradiance_text(View<const float> light) {
  std::string text;
  for (const Mat4& m : irradiance_matrices(project(light, LatLong{light.size()}, 2))) {
    for (int k = 0; k < 16; ++k) text += fmt::format("{:.7g} ", m(k / 4, k % 4));
  }
  text.pop_back();
  return text;
}

std::string controls(double stops) {
  const double start = std::round(2 * stops) / 2;
  return fmt::format(
      "<div class=\"controls\"><label>show <select class=\"view\"><option value=\"2\">objects lit by it</option>"
      "<option value=\"0\">from inside</option><option value=\"1\">from outside</option></select></label> "
      "<label>exposure <input class=\"exposure\" type=\"range\" min=\"{}\" max=\"{}\" step=\"0.5\" value=\"{}\"/> "
      "<output class=\"exposure-value\"></output></label> "
      "<label>glare <input class=\"glare\" type=\"range\" min=\"0\" max=\"0.3\" step=\"0.01\" value=\"0.06\"/></label> "
      "<label>roughness <input class=\"roughness\" type=\"range\" min=\"{}\" max=\"1\" step=\"0.01\" value=\"0.3\"/>"
      "</label> <label>tone <select class=\"tone\"><option value=\"filmic\">filmic</option><option value=\"clip\">clip"
      "</option></select></label></div>\n",
      start - 12, start + 12, start, kRoughness[0]);
}

}  // namespace

std::string html_of(const ProbeView& view, Page& page) {
  HDR_ASSERT(view.latlong.channels() == 3 && !view.latlong.empty());
  page.use(assets::kPictureScript);
  page.use(assets::kShaderScript);
  page.use(assets::kProbeScript);
  const Image<float> light = only_light(view.latlong);
  const Prefilter prefilter(light);
  std::vector<Image<float>> levels;
  std::string roughness;
  for (const double r : kRoughness) {
    levels.push_back(prefilter.latlong(kLevelSize, r, Lobe::kGgx, kSamples));
    roughness += fmt::format("{}{}", roughness.empty() ? "" : " ", r);
  }
  std::string out = fmt::format(
      "<div class=\"viewer\" id=\"{0}\" data-probe=\"{0}-data\" data-levels=\"{0}-levels\" data-table=\"{0}-table\" "
      "data-roughness=\"{1}\" data-irradiance=\"{2}\">\n<div class=\"canvas\"><canvas tabindex=\"0\" "
      "aria-label=\"drag to turn; arrow keys, plus and minus\"></canvas></div>\n",
      view.id, roughness, irradiance_text(light));
  out += controls(view.stops);
  out +=
      "<p class=\"under\"><output class=\"readout\">Drag to turn it; two fingers, or + and −, to come nearer.</output>"
      "</p>\n";
  out += embedded_radiance(view.id + "-data", light) + embedded_levels(view.id + "-levels", levels);
  return out + embedded_radiance(view.id + "-table", split_sum_table(kTableSize)) + "</div>\n";
}

}  // namespace hdr::report
