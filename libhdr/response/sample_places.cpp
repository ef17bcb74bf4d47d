#include "libhdr/response/internal/sample_places.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/rows.h"

namespace hdr::internal {

std::vector<SamplePlace> jittered_places(Size size, int count) {
  const double step = std::max(1.0, std::sqrt(static_cast<double>(size.width) * size.height / count));
  std::vector<SamplePlace> places;
  std::uint64_t cell = 0;
  for (double y = 0; y < size.height; y += step) {
    for (double x = 0; x < size.width; x += step) {
      Random random(0x5eed, cell++);
      const double u = x + step * random.uniform(), v = y + step * random.uniform();
      places.push_back({std::min(static_cast<int>(u), size.width - 1), std::min(static_cast<int>(v), size.height - 1)});
    }
  }
  return places;
}

std::vector<SamplePlace> places_in_photo(const std::vector<SamplePlace>& places, const Mat3* ref_from_photo,
                                         Size size) {
  if (ref_from_photo == nullptr || ref_from_photo->isIdentity(0)) return places;
  const Mat3 photo_from_ref = ref_from_photo->inverse();
  std::vector<SamplePlace> moved;
  moved.reserve(places.size());
  for (const SamplePlace& place : places) {
    const Vec2 p = (photo_from_ref * Vec3(place.x, place.y, 1)).hnormalized();
    const bool inside = p.x() > -0.5 && p.y() > -0.5 && p.x() < size.width - 0.5 && p.y() < size.height - 0.5;
    moved.push_back(inside ? SamplePlace{static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))}
                           : SamplePlace{-1, -1});
  }
  return moved;
}

std::array<std::vector<int>, 3> codes_at_places(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo,
                                                const std::vector<SamplePlace>& places) {
  HDR_ASSERT(ref_from_photo.empty() || ref_from_photo.size() == bracket.shots.size());
  const std::size_t shots = bracket.shots.size();
  std::array<std::vector<int>, 3> codes;
  for (std::vector<int>& channel : codes) channel.assign(places.size() * shots, -1);
  for_rows(static_cast<int>(shots), 1, [&](int shot, int) {
    const auto j = static_cast<std::size_t>(shot);
    const std::vector<SamplePlace> seen =
        places_in_photo(places, ref_from_photo.empty() ? nullptr : &ref_from_photo[j], bracket.size());
    std::visit(
        [&](const auto& image) {
          for (std::size_t i = 0; i < seen.size(); ++i) {
            if (seen[i].x < 0) continue;
            for (std::size_t c = 0; c < 3; ++c) {
              codes[c][i * shots + j] = image(seen[i].x, seen[i].y, static_cast<int>(c));
            }
          }
        },
        LoadedShot(bracket.shots[j])->codes);
  });
  return codes;
}

}  // namespace hdr::internal
