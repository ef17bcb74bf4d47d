#include "libhdr/align/warp.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/rows.h"

namespace hdr {
namespace {

template <class Code>
Image<Code> warp_codes(const Image<Code>& source, const Mat3& photo_from_ref,
                       const std::array<std::vector<float>, 3>& exposure) {
  Image<Code> out(source.size(), 3);
  for_rows(out.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < out.width(); ++x) {
        const Vec3 p = photo_from_ref * Vec3(x, y, 1);
        const double px = p.x() / p.z(), py = p.y() / p.z();
        if (!(px >= 0 && py >= 0 && px <= source.width() - 1 && py <= source.height() - 1)) continue;
        const int x0 = std::min(static_cast<int>(px), std::max(0, source.width() - 2));
        const int y0 = std::min(static_cast<int>(py), std::max(0, source.height() - 2));
        const int x1 = std::min(x0 + 1, source.width() - 1), y1 = std::min(y0 + 1, source.height() - 1);
        const float fx = static_cast<float>(px - x0), fy = static_cast<float>(py - y0);
        for (int c = 0; c < 3; ++c) {
          const std::vector<float>& table = exposure[static_cast<std::size_t>(c)];
          const auto linear = [&](int xx, int yy) { return table[source(xx, yy, c)]; };
          const float top = linear(x0, y0) * (1 - fx) + linear(x1, y0) * fx;
          const float bottom = linear(x0, y1) * (1 - fx) + linear(x1, y1) * fx;
          const float value = top * (1 - fy) + bottom * fy;
          // The nearest code: the table is nondecreasing.
          auto above = std::lower_bound(table.begin(), table.end(), value);
          if (above == table.end()) --above;
          if (above != table.begin() && value - *(above - 1) < *above - value) --above;
          out(x, y, c) = static_cast<Code>(above - table.begin());
        }
      }
    }
  });
  return out;
}

}  // namespace

Photo warp(const Photo& photo, const Mat3& ref_from_photo, const Response& response) {
  std::array<std::vector<float>, 3> exposure;
  for (int c = 0; c < 3; ++c) exposure[static_cast<std::size_t>(c)] = response.exposure_table(c);
  const Mat3 photo_from_ref = ref_from_photo.inverse();
  Photo out{photo.path, photo.exposure, photo.bits, photo.lossy, {}, {}};
  std::visit(
      [&](const auto& codes) {
        if (ref_from_photo.isIdentity(0)) {
          out.codes = codes.clone();
        } else {
          out.codes = warp_codes(codes, photo_from_ref, exposure);
        }
      },
      LoadedShot(photo)->codes);
  return out;
}

}  // namespace hdr
