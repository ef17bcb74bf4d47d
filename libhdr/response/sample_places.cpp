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

CodesAtPlaces::CodesAtPlaces(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo,
                             std::vector<SamplePlace> places)
    : size_(bracket.size()), shots_(bracket.shots.size()), ref_from_photo_(ref_from_photo), places_(std::move(places)) {
  HDR_ASSERT(ref_from_photo.empty() || ref_from_photo.size() == shots_);
  for (std::vector<int>& channel : codes_) channel.assign(places_.size() * shots_, -1);
}

void CodesAtPlaces::look_at(std::size_t j, const Photo& photo) {
  const std::vector<SamplePlace> seen =
      places_in_photo(places_, ref_from_photo_.empty() ? nullptr : &ref_from_photo_[j], size_);
  const auto read = [&](const auto& image) {
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i].x < 0) continue;
      for (std::size_t c = 0; c < 3; ++c) codes_[c][i * shots_ + j] = image(seen[i].x, seen[i].y, static_cast<int>(c));
    }
  };
  std::visit(read, photo.codes);
}

void CodesAtPlaces::look_at(const Bracket& bracket) {
  for_rows(static_cast<int>(shots_), 1, [&](int shot, int) {
    const auto j = static_cast<std::size_t>(shot);
    look_at(j, *LoadedShot(bracket.shots[j]));
  });
}

}  // namespace hdr::internal
