#include "libhdr/light/sh_window.h"

#include <cmath>
#include <functional>

#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

double sinc(double x) {
  return std::abs(x) < 1e-8 ? 1 : std::sin(x) / x;
}

WindowedSh with_factors(const Sh& sh, const std::function<double(int l)>& factor) {
  WindowedSh result{sh, {}};
  for (int l = 0; l <= sh.degree; ++l) {
    const double f = factor(l);
    result.factors.push_back(f);
    for (int m = -l; m <= l; ++m) result.sh.coefficients[static_cast<std::size_t>(l * (l + 1) + m)] *= f;
  }
  return result;
}

// `blur` is 1 / w: 0 leaves all as it is, 1 leaves band 0 alone.
WindowedSh blurred(const Sh& sh, double blur) {
  return with_factors(sh, [blur](int l) { return l * blur >= 1 ? 0.0 : std::pow(sinc(kPi * l * blur), 4); });
}

bool rings(const Sh& sh) {
  return (least_irradiance(sh) < 0).any();
}

WindowedSh without_ringing(const Sh& sh) {
  if (!rings(sh)) return blurred(sh, 0);
  // Between a window that rings and one that does not (band 0 alone): what is returned was seen not to.
  double rings_at = 0, clean_at = 1;
  for (int step = 0; step < 20; ++step) {
    const double middle = 0.5 * (rings_at + clean_at);
    (rings(blurred(sh, middle).sh) ? rings_at : clean_at) = middle;
  }
  return blurred(sh, clean_at);
}

}  // namespace

std::optional<ShWindow> sh_window_from_name(const std::string& name) {
  if (name == "none") return ShWindow::kNone;
  if (name == "hann") return ShWindow::kHann;
  if (name == "lanczos") return ShWindow::kLanczos;
  if (name == "auto") return ShWindow::kAuto;
  return std::nullopt;
}

WindowedSh windowed(const Sh& sh, ShWindow window) {
  const double width = sh.degree + 1;
  switch (window) {
    case ShWindow::kHann:
      return with_factors(sh, [width](int l) { return 0.5 * (1 + std::cos(kPi * l / width)); });
    case ShWindow::kLanczos:
      return with_factors(sh, [width](int l) { return sinc(kPi * l / width); });
    case ShWindow::kAuto:
      return without_ringing(sh);
    case ShWindow::kNone:
      break;
  }
  return with_factors(sh, [](int) { return 1.0; });
}

}  // namespace hdr
