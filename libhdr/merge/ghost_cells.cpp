#include "libhdr/merge/internal/ghost_cells.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/parallel.h"

namespace hdr::internal {
namespace {

constexpr double kMostCells = 5e5;
constexpr int kFewestPixels = 2;
/// Columns that are resampled at a time, about.
constexpr int kSegment = 512;
/// A resampled value under this trust lacks a clipped neighbour (resample.h).
constexpr float kBesideClipped = 5e-4f;

/// Sums over one row of cells.
struct CellSums {
  std::vector<float> level;
  std::vector<int> count;
  std::vector<std::uint8_t> flags;

  void reset(int cells) {
    level.assign(3 * static_cast<std::size_t>(cells), 0);
    count.assign(static_cast<std::size_t>(cells), 0);
    flags.assign(static_cast<std::size_t>(cells), 0);
  }
};

struct Worker {
  CellSums sums;
  Resampler::Patch patch;
  std::vector<WarpedRow> rows;
};

std::uint8_t flag_of(CellPicture::Flag flag, std::size_t channel) {
  return static_cast<std::uint8_t>(flag << channel);
}

template <class Code>
void add_codes(const Code* codes, const CellGrid& grid, const MergeModel& model, CellSums& sums) {
  const float* table[3] = {model.channel[0].level.data(), model.channel[1].level.data(), model.channel[2].level.data()};
  const int clipped = model.clipped_code;
  for (int cell = 0, x = 0; cell < grid.cells.width; ++cell) {
    const int end = std::min(grid.size.width, x + grid.side);
    float sum[3] = {0, 0, 0};
    int least[3] = {1 << 16, 1 << 16, 1 << 16}, most[3] = {0, 0, 0};
    for (int k = x; k < end; ++k) {
      for (int c = 0; c < 3; ++c) {
        const int code = codes[3 * k + c];
        sum[c] += table[c][code];
        least[c] = std::min(least[c], code);
        most[c] = std::max(most[c], code);
      }
    }
    const auto at = static_cast<std::size_t>(cell);
    for (std::size_t c = 0; c < 3; ++c) {
      sums.level[3 * at + c] += sum[c];
      if (most[c] >= clipped) sums.flags[at] |= flag_of(CellPicture::kClipped, c);
      if (least[c] <= model.channel[c].black_code) sums.flags[at] |= flag_of(CellPicture::kBlack, c);
    }
    sums.count[at] += end - x;
    x = end;
  }
}

/// Columns x0 .. x1 - 1, which `row` holds.
void add_warped(const WarpedRow& row, int x0, int x1, const CellGrid& grid, const MergeModel& model, CellSums& sums) {
  for (int x = x0; x < x1; ++x) {
    const auto at = static_cast<std::size_t>(x / grid.side), pixel = static_cast<std::size_t>(x - x0);
    ++sums.count[at];
    for (std::size_t c = 0; c < 3; ++c) {
      const ChannelModel& channel = model.channel[c];
      const float level = row.level[c][pixel];
      sums.level[3 * at + c] += level;
      if (level < 0) sums.flags[at] |= CellPicture::kOutside;
      if (level >= channel.clip_bound || row.trust[c][pixel] < kBesideClipped) {
        sums.flags[at] |= flag_of(CellPicture::kClipped, c);
      }
      if (level <= channel.black_bound) sums.flags[at] |= flag_of(CellPicture::kBlack, c);
    }
  }
}

void put(const CellSums& sums, int row, const CellGrid& grid, const MergeModel& model, CellPicture& out) {
  const auto width = static_cast<std::size_t>(grid.cells.width), start = static_cast<std::size_t>(row) * width;
  for (std::size_t k = 0; k < width; ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float mean = sums.level[3 * k + c] / static_cast<float>(sums.count[k]);
      const bool clipped = sums.flags[k] & flag_of(CellPicture::kClipped, c);
      out.level[3 * (start + k) + c] = clipped ? std::min(mean, model.channel[c].clip_bound) : mean;
    }
    out.flags[start + k] = sums.flags[k];
  }
}

void add_row_of_cells(const Source& source, int row, const CellGrid& grid, const MergeModel& model, Worker& worker) {
  const int y0 = row * grid.side, y1 = std::min(grid.size.height, y0 + grid.side);
  if (source.registered()) {
    for (int y = y0; y < y1; ++y) {
      if (model.bits <= 8) {
        add_codes(static_cast<const std::uint8_t*>(source.codes(y)), grid, model, worker.sums);
      } else {
        add_codes(static_cast<const std::uint16_t*>(source.codes(y)), grid, model, worker.sums);
      }
    }
    return;
  }
  const int step = grid.side * std::max(1, kSegment / grid.side);
  for (int x0 = 0; x0 < grid.size.width; x0 += step) {
    const int x1 = std::min(grid.size.width, x0 + step);
    if (worker.rows.empty()) worker.rows.assign(static_cast<std::size_t>(grid.side), WarpedRow(step));
    source.warp({x0, y0, x1, y1}, worker.patch, worker.rows);
    for (int y = y0; y < y1; ++y) {
      add_warped(worker.rows[static_cast<std::size_t>(y - y0)], x0, x1, grid, model, worker.sums);
    }
  }
}

}  // namespace

CellGrid cell_grid(Size size) {
  CellGrid grid{size, kFewestPixels, {}};
  const double pixels = static_cast<double>(size.width) * size.height;
  grid.side = std::max(kFewestPixels, static_cast<int>(std::ceil(std::sqrt(pixels / kMostCells))));
  grid.cells = {(size.width + grid.side - 1) / grid.side, (size.height + grid.side - 1) / grid.side};
  return grid;
}

int band_height_of(const CellGrid& grid) {
  constexpr int kRows = 64;
  return grid.side * std::max(1, kRows / grid.side);
}

std::vector<CellPicture> cell_pictures(const CellGrid& grid, const MergeModel& model,
                                       const std::vector<std::unique_ptr<Source>>& sources) {
  const auto count = static_cast<std::size_t>(grid.count());
  std::vector<CellPicture> pictures(sources.size());
  for (CellPicture& picture : pictures) {
    picture.level.resize(3 * count);
    picture.flags.resize(count);
  }
  const int band_height = band_height_of(grid), rows_a_band = band_height / grid.side;
  std::vector<Worker> workers(static_cast<std::size_t>(rows_a_band));
  for (int first = 0; first < grid.cells.height; first += rows_a_band) {
    for_rows(static_cast<int>(sources.size()), 1,
             [&](int shot, int) { sources[static_cast<std::size_t>(shot)]->advance(first / rows_a_band); });
    for_rows(std::min(rows_a_band, grid.cells.height - first), 1, [&](int task, int) {
      Worker& worker = workers[static_cast<std::size_t>(task)];
      for (std::size_t shot = 0; shot < sources.size(); ++shot) {
        worker.sums.reset(grid.cells.width);
        add_row_of_cells(*sources[shot], first + task, grid, model, worker);
        put(worker.sums, first + task, grid, model, pictures[shot]);
      }
    });
  }
  return pictures;
}

}  // namespace hdr::internal
