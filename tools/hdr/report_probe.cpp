#include "tools/hdr/report_probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/filter/tonemap.h"
#include "libhdr/probe/projection.h"
#include "libhdr/probe/unwrap.h"
#include "tools/hdr/report/html.h"
#include "tools/hdr/report/picture.h"
#include "tools/hdr/report/probe_view.h"

namespace hdr::tools {
namespace {

constexpr int kWidest = 1024;  ///< of the lat-long in the page
constexpr int kRenderPixels = 640 * 480;

/// Standard error of luminance over its value, as light: 1 is 100 %. Empty when no pixel's is known.
Image<float> relative_error(const Rendering& result) {
  const View<const float> variance = result.variance;
  Image<float> out(variance.width(), variance.height(), 3);
  bool known = false;
  for (int y = 0; y < out.height(); ++y) {
    for (int x = 0; x < out.width(); ++x) {
      const float* p = result.picture.rgb.pixel(x, y);
      const double value = luminance(p[0], p[1], p[2]);
      if (!(value > 0 && variance(x, y) > 0)) continue;
      std::fill_n(out.pixel(x, y), 3, static_cast<float>(std::sqrt(variance(x, y)) / value));
      known = true;
    }
  }
  return known ? std::move(out) : Image<float>();
}

}  // namespace

void add_probe(report::Page& page, const RadianceMap& probe) {
  const std::optional<Projection> from = projection_from_text(probe.projection, probe.size());
  if (!from) return;
  const auto* latlong = std::get_if<LatLong>(&*from);
  const int width = latlong ? std::min(kWidest, probe.size().width) : kWidest;
  const Size size{width, std::max(1, width / 2)};
  const Image<float> shown = resample(probe.rgb, *from, LatLong{size}, size);
  page.add(
      {"probe", "The light probe",
       html_of(report::ProbeView{"viewer", shown, metered_stops(shown)}, page) +
           "<p>Left: white paint (albedo .8), from nine harmonics a channel. Middle: gold, from the levels blurred for "
           "its roughness. Right: a mirror, which shows the others too. No shadows between them.</p>\n"});
}

void add_ball(report::Page& page, const Json& answer) {
  if (!answer.contains("ball")) return;
  const Json& ball = answer["ball"];
  const auto pixels = [](const Json& value) { return fmt::format("{:.2f}", value.get<double>()); };
  report::Facts facts;
  facts.add("centre, px", pixels(ball["cx"]) + ", " + pixels(ball["cy"]));
  facts.add("radius, px", pixels(ball["r"]));
  facts.add("camera", ball["distance"].is_null()
                          ? "taken for far"
                          : report::number(ball["distance"].get<double>()) + " radii from the centre");
  if (answer.contains("ball_residual_px")) {
    facts.add("outline's own scatter, px", report::number(answer["ball_residual_px"].get<double>(), 2));
    facts.add("of the rim that speaks for it", report::number(100 * answer["ball_support"].get<double>(), 2) + " %");
  }
  std::string what;
  if (ball.contains("direction_doubt_degrees")) {
    const double doubt = ball["direction_doubt_degrees"];
    facts.add("directions", fmt::format("up to {:.1f} degrees off", doubt));
    what = report::element("p",
                           "The picture does not tell how far away the camera was. Were it at 5 radii, directions near "
                           "the rim would be off by that much; --distance or --camera-fov settle it.");
  }
  page.add({"ball", "The mirror ball", facts.html() + what});
}

std::string drawing_of_ball(const Json& answer) {
  if (!answer.contains("ball")) return {};
  const double cx = answer["ball"]["cx"], cy = answer["ball"]["cy"], r = answer["ball"]["r"];
  return fmt::format(
      "<circle class=\"c1\" cx=\"{0:.2f}\" cy=\"{1:.2f}\" r=\"{2:.2f}\"/><path class=\"c1\" d=\"M{3:.2f} "
      "{1:.2f}H{4:.2f}M"
      "{0:.2f} {5:.2f}V{6:.2f}\"/>",
      cx, cy, r, cx - r / 10, cx + r / 10, cy - r / 10, cy + r / 10);
}

void write_render_report(const ReportFlag& flag, const Run& run, const Rendering& result) {
  const RadianceMap& picture = result.picture;
  report::Page page("hdr render",
                    fmt::format("{} x {} pixels by {}, estimated error {}", picture.size().width, picture.size().height,
                                name_of(result.method), report::number(result.estimated_error, 2)));
  add_warnings(page, run);
  report::Facts facts;
  facts.add("method", name_of(result.method));
  facts.add("samples a pixel", report::number(result.samples_per_pixel, 4));
  facts.add("rays", report::number(static_cast<double>(result.rays) / 1e6, 3) + " M");
  facts.add("estimated error", report::number(100 * result.estimated_error, 2) + " %");
  const Image<float> small = report::reduced(picture.rgb.view(), kRenderPixels);
  std::string html = facts.html() + html_of(report::Picture{"picture", small, metered_stops(small), {}, {}, {}}, page);
  page.add({"picture-section", "The picture", html});
  if (const Image<float> error = relative_error(result); !error.empty()) {
    const Image<float> shown = report::reduced(error.view(), kRenderPixels);
    page.add(
        {"error-section", "Where it is unsure",
         "<p>Standard error of each pixel's luminance over its value: white at the exposure of 0 stops is 100 %, at "
         "5 stops 3 %. Black: not lit, or so sure that all its passes agreed.</p>\n" +
             html_of(report::Picture{"error", shown, metered_stops(shown), {}, {}, {}}, page)});
  }
  add_stages(page, run);
  page.write(flag.path);
}

}  // namespace hdr::tools
