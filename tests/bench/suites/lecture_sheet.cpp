#include "tests/bench/suites/lecture_sheet.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "libhdr/core/internal/opencv.h"

namespace hdr::bench {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.42;

// Small tiles have lines that are wider than they are.
int widest_line(const std::vector<Tile>& tiles) {
  int widest = 0;
  for (const Tile& tile : tiles) {
    for (const std::string& line : tile.lines)
      widest = std::max(widest, cv::getTextSize(line, kFont, kFontScale, 1, nullptr).width);
  }
  return widest;
}

}  // namespace

Image<std::uint8_t> contact_sheet(const std::vector<Tile>& tiles, int across) {
  constexpr int kMargin = 12, kLine = 16;
  HDR_ASSERT(!tiles.empty() && across > 0);
  std::size_t most_lines = 0;
  for (const Tile& tile : tiles) most_lines = std::max(most_lines, tile.lines.size());
  const Size tile = tiles[0].codes.size();
  const int down = (static_cast<int>(tiles.size()) + across - 1) / across;
  const int step_x = std::max(tile.width, widest_line(tiles)) + kMargin;
  const int step_y = tile.height + kMargin + kLine * (static_cast<int>(most_lines) + 1);
  Image<std::uint8_t> sheet(across * step_x + kMargin, down * step_y + kMargin, 3);
  cv::Mat all = internal::mat_from_view(sheet.view());
  all.setTo(cv::Scalar(255, 255, 255));
  for (std::size_t k = 0; k < tiles.size(); ++k) {
    const int column = static_cast<int>(k) % across, row = static_cast<int>(k) / across;
    const int x0 = kMargin + column * step_x, y0 = kMargin + row * step_y;
    HDR_ASSERT(tiles[k].codes.size() == tile && tiles[k].codes.channels() == 3);
    for (int y = 0; y < tile.height; ++y) {
      std::copy_n(tiles[k].codes.row(y), tiles[k].codes.row_samples(), sheet.pixel(x0, y0 + y));
    }
    for (std::size_t l = 0; l < tiles[k].lines.size(); ++l) {
      cv::putText(all, tiles[k].lines[l], {x0, y0 + tile.height + kLine * (static_cast<int>(l) + 1)}, kFont, kFontScale,
                  cv::Scalar(20, 20, 20), 1, cv::LINE_AA);
    }
  }
  return sheet;
}

}  // namespace hdr::bench
