#include "tools/hdr/report/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/hdr/report/assets.h"
#include "tools/hdr/report/embed.h"
#include "tools/hdr/report/html.h"

namespace hdr::report {
namespace {

/// [Okabe08], as style.css has it on a dark ground.
const char* rgb_text(Colour colour) {
  static constexpr const char* kCodes[] = {"255 255 255", "230 159 0", "86 180 233", "0 158 115",
                                           "240 228 66",  "0 114 178", "213 94 0",   "204 121 167"};
  return kCodes[static_cast<int>(colour)];
}

std::string controls(const Picture& picture) {
  // From there a person looks up and down: whole and half stops.
  const double start = std::round(2 * picture.stops) / 2;
  std::string out = fmt::format(
      "<div class=\"controls\"><label>exposure <input class=\"exposure\" type=\"range\" min=\"{}\" max=\"{}\" "
      "step=\"0.5\" value=\"{}\"/> <output class=\"exposure-value\"></output></label> "
      "<label>tone <select class=\"tone\"><option value=\"filmic\">filmic</option><option value=\"clip\">clip"
      "</option><option value=\"false\">stops as colours</option></select></label> ",
      start - 12, start + 12, start);
  for (std::size_t k = 0; k < picture.overlays.size(); ++k) {
    const Overlay& overlay = picture.overlays[k];
    out += fmt::format(
        "<label><input type=\"checkbox\" data-mask=\"{}-mask-{}\" data-colour=\"{}\"{}/> <span class=\"key "
        "c{}\"></span>"
        "{}</label> ",
        picture.id, k, rgb_text(overlay.colour), overlay.shown ? " checked=\"checked\"" : "",
        static_cast<int>(overlay.colour), escaped(overlay.name));
  }
  return out + "</div>\n";
}

}  // namespace

std::string html_of(const Picture& picture, Page& page) {
  HDR_ASSERT(picture.rgb.channels() == 3);
  page.use(assets::kPictureScript);
  const Size size = picture.size.width > 0 ? picture.size : picture.rgb.size();
  std::string out = fmt::format("<div class=\"picture\" id=\"{0}\" data-source=\"{0}-data\">\n", picture.id);
  out += fmt::format("<div class=\"canvas\"><canvas width=\"{}\" height=\"{}\"></canvas>", picture.rgb.width(),
                     picture.rgb.height());
  if (!picture.drawing.empty()) {
    out += fmt::format("<svg class=\"over\" viewBox=\"0 0 {} {}\">{}</svg>", size.width, size.height, picture.drawing);
  }
  out += "</div>\n<p class=\"stops\" hidden=\"hidden\"></p>\n" + controls(picture);
  out += "<p class=\"under\"><output class=\"readout\"></output></p>\n";
  out += embedded_radiance(picture.id + "-data", picture.rgb);
  for (std::size_t k = 0; k < picture.overlays.size(); ++k) {
    HDR_ASSERT(picture.overlays[k].mask.size() == picture.rgb.size());
    out += embedded_bytes(fmt::format("{}-mask-{}", picture.id, k), picture.overlays[k].mask);
  }
  return out + "</div>\n";
}

Size reduced_size(Size size, int pixels) {
  const double ratio = std::sqrt(static_cast<double>(pixels) / (static_cast<double>(size.width) * size.height));
  if (ratio >= 1) return size;
  return {std::max(1, static_cast<int>(ratio * size.width)), std::max(1, static_cast<int>(ratio * size.height))};
}

Image<float> reduced(View<const float> rgb, int pixels) {
  const Size size = reduced_size(rgb.size(), pixels);
  Image<float> out(size, rgb.channels());
  std::vector<double> sums(static_cast<std::size_t>(rgb.channels()));
  const auto edge = [](int k, int from, int to) { return static_cast<int>(static_cast<std::int64_t>(k) * to / from); };
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int x0 = edge(x, size.width, rgb.width()), x1 = edge(x + 1, size.width, rgb.width());
      const int y0 = edge(y, size.height, rgb.height()), y1 = edge(y + 1, size.height, rgb.height());
      std::fill(sums.begin(), sums.end(), 0.0);
      for (int v = y0; v < y1; ++v) {
        for (int u = x0; u < x1; ++u) {
          for (std::size_t c = 0; c < sums.size(); ++c) sums[c] += rgb.pixel(u, v)[c];
        }
      }
      for (std::size_t c = 0; c < sums.size(); ++c) {
        out.pixel(x, y)[c] = static_cast<float>(sums[c] / (static_cast<double>(x1 - x0) * (y1 - y0)));
      }
    }
  }
  return out;
}

Image<std::uint8_t> reduced(View<const std::uint8_t> mask, Size size) {
  HDR_ASSERT(size.width <= mask.width() && size.height <= mask.height());
  Image<std::uint8_t> out(size, 1);
  // The cell k with floor(k from / to) <= place: the same cells as above.
  const auto cell = [](int place, int from, int to) {
    return static_cast<int>(((static_cast<std::int64_t>(place) + 1) * to - 1) / from);
  };
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      std::uint8_t& most = out(cell(x, mask.width(), size.width), cell(y, mask.height(), size.height));
      most = std::max(most, mask(x, y));
    }
  }
  return out;
}

}  // namespace hdr::report
