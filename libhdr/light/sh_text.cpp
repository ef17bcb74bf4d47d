#include "libhdr/light/sh_text.h"

#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/light/internal/clamped_cosine.h"

namespace hdr {
namespace {

Rgb coefficient(const Sh& sh, std::size_t k) {
  return k < sh.coefficients.size() ? sh.coefficients[k] : Rgb(Rgb::Zero());
}

std::string triple(const Rgb& c) {
  return fmt::format("{:.9g}, {:.9g}, {:.9g}", c[0], c[1], c[2]);
}

std::string c_header(const Sh& sh) {
  std::string text =
      "/* Spherical harmonics of a light probe: real, orthonormal, no Condon-Shortley phase, L_lm = integral of L "
      "Y_lm.\n"
      "   Order L00, L1-1 (y), L10 (z), L11 (x), L2-2 (xy), L2-1 (yz), L20 (3z^2-1), L21 (xz), L22 (x^2-y^2), ...\n"
      "   Axes: right-handed, +Y up. Irradiance at unit normal n: (n,1)^T M (n,1), M symmetric, one a channel. */\n"
      "#ifndef HDR_PROBE_SH_H\n#define HDR_PROBE_SH_H\n\n";
  text += fmt::format("#define HDR_PROBE_SH_DEGREE {}\n\n", sh.degree);
  text += fmt::format("static const float hdr_probe_sh[{}][3] = {{\n", sh.coefficients.size());
  for (const Rgb& c : sh.coefficients) text += "    {" + triple(c) + "},\n";
  text += "};\n\nstatic const float hdr_probe_irradiance_matrix[3][4][4] = {\n";
  const std::array<Mat4, 3> matrices = irradiance_matrices(sh);
  for (const Mat4& m : matrices) {
    text += "    {";
    for (int r = 0; r < 4; ++r) {
      text += fmt::format("{{{:.9g}, {:.9g}, {:.9g}, {:.9g}}}", m(r, 0), m(r, 1), m(r, 2), m(r, 3));
      text += r < 3 ? ",\n     " : "},\n";
    }
  }
  text +=
      "};\n\nstatic float hdr_probe_irradiance(int channel, const float n[3]) {\n"
      "  const float v[4] = {n[0], n[1], n[2], 1};\n  float e = 0;\n  int i, j;\n"
      "  for (i = 0; i < 4; ++i)\n"
      "    for (j = 0; j < 4; ++j) e += v[i] * hdr_probe_irradiance_matrix[channel][i][j] * v[j];\n"
      "  return e;\n}\n\n#endif\n";
  return text;
}

std::string three_js(const Sh& sh) {
  std::string text = "[\n";
  for (std::size_t k = 0; k < 9; ++k) {
    text += "  " + triple(coefficient(sh, k));
    text += k < 8 ? ",\n" : "\n";
  }
  return text + "]\n";
}

std::string filament(const Sh& sh) {
  static constexpr const char* kTerms[] = {"1", "y", "z", "x", "xy", "yz", "3z^2-1", "zx", "x^2-y^2"};
  const std::array<Rgb, 9> polynomial = irradiance_polynomial(sh);
  std::string text;
  for (std::size_t k = 0; k < 9; ++k) text += fmt::format("({}); // {}\n", triple(polynomial[k]), kTerms[k]);
  return text;
}

std::string unity(const Sh& sh) {
  std::array<Rgb, 9> polynomial = irradiance_polynomial(sh);
  for (const std::size_t k : {2u, 5u, 7u}) polynomial[k] = -polynomial[k];  // odd in z
  std::string text = "var sh = new UnityEngine.Rendering.SphericalHarmonicsL2();\n";
  for (int c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < 9; ++k) text += fmt::format("sh[{}, {}] = {:.9g}f;\n", c, k, polynomial[k][c]);
  return text;
}

}  // namespace

std::array<Rgb, 9> irradiance_polynomial(const Sh& sh) {
  // What stands before the polynomials of the basis.
  const double y = std::sqrt(3 / (4 * kPi)), xy = std::sqrt(15 / (4 * kPi));
  const double factors[] = {std::sqrt(1 / (4 * kPi)), y, y, y, xy, xy, std::sqrt(5 / (16 * kPi)), xy, 0.5 * xy};
  std::array<Rgb, 9> polynomial;
  for (std::size_t k = 0; k < 9; ++k) {
    const int l = k == 0 ? 0 : k < 4 ? 1 : 2;
    polynomial[k] = clamped_cosine_coefficient(l) / kPi * factors[k] * coefficient(sh, k);
  }
  return polynomial;
}

std::string text_of(const Sh& sh, ShFormat format) {
  switch (format) {
    case ShFormat::kC:
      return c_header(sh);
    case ShFormat::kThreeJs:
      return three_js(sh);
    case ShFormat::kFilament:
      return filament(sh);
    case ShFormat::kUnity:
      return unity(sh);
  }
  return {};
}

}  // namespace hdr
