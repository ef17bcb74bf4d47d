#include "libhdr/io/internal/rec709.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "libhdr/core/parallel.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {
namespace {

/// Columns: XYZ of the primaries, scaled so that RGB = (1,1,1) is white with Y = 1. nullopt when they span nothing.
std::optional<Mat3> xyz_from_rgb(const Chromaticities& xy) {
  const auto xyz = [](const float(&p)[2]) { return Vec3(p[0], p[1], 1.0 - p[0] - p[1]); };
  Mat3 primaries;
  primaries << xyz(xy.red), xyz(xy.green), xyz(xy.blue);
  constexpr double kFlat = 1e-6;
  if (!primaries.allFinite() || std::abs(primaries.determinant()) < kFlat || !(std::abs(xy.white[1]) > kFlat)) {
    return std::nullopt;
  }
  const Vec3 scale = primaries.inverse() * (xyz(xy.white) / xy.white[1]);
  if (!scale.allFinite()) return std::nullopt;
  return primaries * scale.asDiagonal();
}

/// image = |matrix|^power (sums of squares for standard deviations).
void transform(Image<float>& image, const Mat3& matrix, bool squares) {
  if (image.empty()) return;
  const Mat3 m = squares ? Mat3(matrix.cwiseAbs2()) : matrix;
  for_rows(image.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < image.width(); ++x) {
        float* p = image.pixel(x, y);
        Vec3 v(p[0], p[1], p[2]);
        if (squares) v = v.cwiseAbs2();
        Vec3 out = m * v;
        if (squares) out = out.cwiseSqrt();
        for (int c = 0; c < 3; ++c) p[c] = static_cast<float>(out[c]);
      }
    }
  });
}

}  // namespace

void set_chromaticities(OIIO::ImageSpec& spec, const Chromaticities& xy) {
  const float numbers[8] = {xy.red[0],  xy.red[1],  xy.green[0], xy.green[1],
                            xy.blue[0], xy.blue[1], xy.white[0], xy.white[1]};
  spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), numbers);
}

Chromaticities chromaticities_of(const OIIO::ImageSpec& spec) {
  Chromaticities xy;
  const OIIO::ParamValue* found = spec.find_attribute("chromaticities");
  if (!found || found->type().basetype != OIIO::TypeDesc::FLOAT || found->type().numelements() < 8) return xy;
  const auto* v = static_cast<const float*>(found->data());
  for (int i = 0; i < 2; ++i) {
    xy.red[i] = v[i];
    xy.green[i] = v[2 + i];
    xy.blue[i] = v[4 + i];
    xy.white[i] = v[6 + i];
  }
  return xyz_from_rgb(xy) ? xy : Chromaticities{};
}

Mat3 xyz_matrix(const Chromaticities& xy) {
  return xyz_from_rgb(xy).value_or(xyz_from_rgb(Chromaticities{}).value());
}

bool is_rec709(const Chromaticities& xy) {
  const Chromaticities ours;
  constexpr float kSame = 1e-4f;  // 0.3127 and 0.31271 are one white
  bool same = true;
  for (int i = 0; i < 2; ++i) {
    same &= std::abs(xy.red[i] - ours.red[i]) < kSame && std::abs(xy.green[i] - ours.green[i]) < kSame;
    same &= std::abs(xy.blue[i] - ours.blue[i]) < kSame && std::abs(xy.white[i] - ours.white[i]) < kSame;
  }
  return same;
}

void convert_to_rec709(RadianceMap& map) {
  if (is_rec709(map.chromaticities)) return;
  const Mat3 matrix = xyz_matrix(Chromaticities{}).inverse() * xyz_matrix(map.chromaticities);
  transform(map.rgb, matrix, false);
  transform(map.stddev, matrix, true);
  map.chromaticities = {};
}

}  // namespace hdr::internal
