#include "tests/bench/textbook_merge.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"

namespace hdr::bench {

Image<float> textbook_merge(const Bracket& bracket, const Response& response) {
  const Size size = bracket.size();
  Image<float> map(size, 3);
  for_rows(size.height, 4, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        for (int c = 0; c < 3; ++c) {
          double sum = 0, weights = 0;
          for (const Photo& photo : bracket.shots) {
            const int code = std::get<Image<std::uint8_t>>(photo.codes)(x, y, c);
            const double w = std::min(code, 255 - code);
            sum += w * (response.ln_exposure(c, code) - std::log(photo.relative_exposure()));
            weights += w;
          }
          // All black, or all clipped: the longest or the shortest shot.
          const Photo& longest = bracket.shots.back();
          const bool black = std::get<Image<std::uint8_t>>(longest.codes)(x, y, c) < 128;
          const Photo& end = black ? longest : bracket.shots.front();
          const double bound = response.ln_exposure(c, black ? 0 : 255) - std::log(end.relative_exposure());
          map(x, y, c) = static_cast<float>(std::exp(weights > 0 ? sum / weights : bound));
        }
      }
    }
  });
  return map;
}

}  // namespace hdr::bench
