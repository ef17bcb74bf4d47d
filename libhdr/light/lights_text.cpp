#include "libhdr/light/lights_text.h"

#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

constexpr double kAngle = 0.53;  // degrees across

Vec3 any_normal_to(const Vec3& d) {
  return (std::abs(d.y()) < 0.9 ? Vec3::UnitY().cross(d) : Vec3::UnitX().cross(d)).normalized();
}

}  // namespace

std::string usd_of(const std::vector<DirectionalLight>& lights) {
  std::string text = "#usda 1.0\n(\n    defaultPrim = \"Lights\"\n    upAxis = \"Y\"\n)\n\ndef Xform \"Lights\"\n{\n";
  for (std::size_t k = 0; k < lights.size(); ++k) {
    const Vec3 z = lights[k].direction, x = any_normal_to(z), y = z.cross(x);
    const double brightest = lights[k].irradiance.maxCoeff();
    const Rgb color = brightest > 0 ? Rgb(lights[k].irradiance / brightest) : Rgb(Rgb::Ones());
    text += fmt::format("    def DistantLight \"Light_{:04d}\"\n    {{\n", k);
    text += fmt::format("        float inputs:angle = {}\n        bool inputs:normalize = 1\n", kAngle);
    text += fmt::format("        color3f inputs:color = ({:.9g}, {:.9g}, {:.9g})\n", color[0], color[1], color[2]);
    text += fmt::format("        float inputs:intensity = {:.9g}\n", brightest);
    // USD's matrices act on row vectors: the rows are the axes.
    text += fmt::format(
        "        matrix4d xformOp:transform = ( ({:.9g}, {:.9g}, {:.9g}, 0), ({:.9g}, {:.9g}, {:.9g}, 0), ({:.9g}, "
        "{:.9g}, {:.9g}, 0), (0, 0, 0, 1) )\n",
        x.x(), x.y(), x.z(), y.x(), y.y(), y.z(), z.x(), z.y(), z.z());
    text += "        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n    }\n";
  }
  return text + "}\n";
}

std::string rad_of(const std::vector<DirectionalLight>& lights) {
  std::string text = "# directional lights of a probe; +Z is up: (x, y, z) of the probe is (x, -z, y) here\n";
  const double sine = std::sin(0.5 * kAngle * kDegree);
  for (std::size_t k = 0; k < lights.size(); ++k) {
    const DirectionalLight& light = lights[k];
    if (!(light.irradiance > 0).any()) continue;
    // A disc of constant radiance L that is sin(a) wide gives pi L sin^2(a) to a surface that faces it.
    const Rgb radiance = light.irradiance / (kPi * sine * sine);
    text += fmt::format("\nvoid light probe_{0}\n0\n0\n3 {1:.9g} {2:.9g} {3:.9g}\nprobe_{0} source sun_{0}\n0\n0\n4 ",
                        k, radiance[0], radiance[1], radiance[2]);
    text += fmt::format("{:.9g} {:.9g} {:.9g} {}\n", light.direction.x(), -light.direction.z(), light.direction.y(),
                        kAngle);
  }
  return text;
}

}  // namespace hdr
