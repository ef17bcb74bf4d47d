#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libhdr/core/internal/opencv.h"
#include "libhdr/filter/internal/display.h"
#include "libhdr/filter/internal/quantile.h"
#include "libhdr/filter/tonemap.h"

namespace hdr {
namespace {

using Colour = std::array<std::uint8_t, 3>;

/// [Mikhailov19]: Turbo, a rainbow of even lightness, by its published polynomial; x in [0,1].
Colour turbo(double x) {
  static constexpr double kRed[6] = {0.13572138, 4.61539260, -42.66032258, 132.13108234, -152.94239396, 59.28637943};
  static constexpr double kGreen[6] = {0.09140261, 2.19418839, 4.84296658, -14.18503333, 4.27729857, 2.82956604};
  static constexpr double kBlue[6] = {0.10667330, 12.64194608, -60.58204836, 110.36276771, -89.90310912, 27.34824973};
  const auto code = [x](const double(&a)[6]) {
    double value = 0;
    for (int k = 5; k >= 0; --k) value = value * x + a[k];
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
  };
  return {code(kRed), code(kGreen), code(kBlue)};
}

constexpr double kGrey = 0.18;
constexpr int kMostStops = 40;

/// A patch for each stop with its number, in the lowest rows.
void draw_legend(Image<std::uint8_t>& picture, int top, int lowest, int highest) {
  const int count = highest - lowest, height = picture.height() - top;
  cv::Mat mat = internal::mat_from_view(picture.view());
  for (int k = 0; k < count; ++k) {
    const int left = picture.width() * k / count, right = picture.width() * (k + 1) / count;
    const Colour c = turbo((k + 0.5) / count);
    cv::rectangle(mat, {left, top}, {right - 1, picture.height() - 1}, cv::Scalar(c[0], c[1], c[2]), cv::FILLED);
    const std::string text = fmt::format("{:+d}", lowest + k);
    int baseline = 0;
    const cv::Size unit = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 1, 1, &baseline);
    const double scale = std::min(0.6 * height / unit.height, 0.8 * (right - left) / unit.width);
    if (scale < 0.2) continue;  // no room for a number that can be read
    const bool dark = luminance<int>(c[0], c[1], c[2]) < 110;
    const cv::Point at(left + static_cast<int>(0.5 * (right - left - scale * unit.width)),
                       top + static_cast<int>(0.5 * (height + scale * unit.height)));
    cv::putText(mat, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, dark ? cv::Scalar(255, 255, 255) : cv::Scalar(0, 0, 0),
                1, cv::LINE_AA);
  }
}

}  // namespace

FalseColour false_colour(View<const float> rgb, double stops) {
  const double gain = internal::gain_from_stops(stops) / kGrey;
  const auto stop_of = [&](double value) { return value > 0 ? std::log2(gain * value) : -1e9; };
  FalseColour result;
  const double high = stop_of(internal::luminance_quantile(rgb, 0.999));
  const double low = std::max(stop_of(internal::luminance_quantile(rgb, 0.001)), high - kMostStops);
  const bool is_black = high < -1e8;
  result.lowest = is_black ? 0 : static_cast<int>(std::floor(low));
  result.highest = is_black ? 1 : std::max(result.lowest + 1, static_cast<int>(std::floor(high)) + 1);
  const int legend = std::clamp(rgb.width() / 24, 12, 48);
  result.picture = Image<std::uint8_t>(rgb.width(), rgb.height() + legend, 3);
  const int count = result.highest - result.lowest;
  for_rows(rgb.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < rgb.width(); ++x) {
        const double stop = std::floor(stop_of(internal::pixel_luminance(rgb.pixel(x, y)))) - result.lowest;
        if (stop < 0) continue;  // below the range: black
        const Colour c = turbo((std::min<double>(stop, count - 1) + 0.5) / count);
        std::copy_n(c.data(), 3, result.picture.pixel(x, y));
      }
    }
  });
  draw_legend(result.picture, rgb.height(), result.lowest, result.highest);
  return result;
}

}  // namespace hdr
