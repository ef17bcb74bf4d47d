#include "libhdr/align/internal/log_picture.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/response/noise.h"

namespace hdr::internal {
namespace {

constexpr int kRowsPerBlock = 32;

/// Mean of the usable samples x0, x0 + step, ... of one cell.
template <class Code>
void average_cell(View<const Code> codes, const Linearizer& linearizer, int x0, int y0, int cell, int step, double h,
                  float& ln, float& variance) {
  const Linearizer::Level* const red = linearizer.table(0);
  const Linearizer::Level* const green = linearizer.table(1);
  const Linearizer::Level* const blue = linearizer.table(2);
  float exposure = 0, sum_variance = 0;
  for (int y = y0; y < y0 + cell; y += step) {
    const Code* p = codes.pixel(x0, y);
    for (int x = 0; x < cell; x += step, p += 3 * step) {
      exposure += red[p[0]].exposure + green[p[1]].exposure + blue[p[2]].exposure;
      sum_variance += red[p[0]].variance + green[p[1]].variance + blue[p[2]].variance;
    }
  }
  const int samples_a_side = (cell + step - 1) / step;
  const auto samples = static_cast<float>(samples_a_side * samples_a_side);
  if (!(sum_variance < kUnusable) || !(exposure > 0)) {
    ln = 0;
    variance = kUnusable;
    return;
  }
  // To first order, var(ln L) = var(L) / L^2.
  ln = std::log(exposure / samples) - static_cast<float>(std::log(h));
  variance = sum_variance / (exposure * exposure);
}

}  // namespace

double usable_share(const PhotoSamples& samples, int max_code) {
  const int first = static_cast<int>(std::ceil(kDarkestCode * max_code));
  const int last = static_cast<int>(kBrightestCode * max_code);
  const auto share = [&](const auto& codes) {
    std::int64_t usable = 0;
    for (int y = 0; y < codes.height(); ++y) {
      const auto* p = codes.row(y);
      for (int x = 0; x < codes.width(); ++x, p += 3) {
        const int r = p[0], g = p[1], b = p[2];
        usable += std::min({r, g, b}) >= first && std::max({r, g, b}) <= last;
      }
    }
    const double pixels = static_cast<double>(codes.width()) * codes.height();
    return pixels > 0 ? static_cast<double>(usable) / pixels : 0.0;
  };
  return std::visit(share, samples.lattice);
}

Linearizer::Linearizer(const Response& response, int bits, bool lossy) {
  const int codes = 1 << bits;
  const double response_code = ((1 << response.bits) - 1.0) / (codes - 1.0);  // the same code, as deep as the response
  const double luminance_weight[3] = {luminance(1.0, 0.0, 0.0), luminance(0.0, 1.0, 0.0), luminance(0.0, 0.0, 1.0)};
  const NoiseModel noise;
  // Rounding adds 1/12 of a squared code; compression, which we know only to be there, a code or so of 8 bits.
  const double code_variance = 1.0 / 12 + (lossy ? std::pow((codes - 1) / 255.0, 2) : 0);
  for (int channel = 0; channel < 3; ++channel) {
    auto& table = table_[channel];
    table.resize(static_cast<std::size_t>(codes));
    const auto exposure_of = [&](int code) { return response.exposure(channel, code * response_code); };
    const double full_well = exposure_of(codes - 1);
    const int first = static_cast<int>(std::ceil(kDarkestCode * (codes - 1)));
    const int last = static_cast<int>(std::floor(kBrightestCode * (codes - 1)));
    for (int code = first; code <= last; ++code) {
      const double exposure = exposure_of(code);
      const double slope = (exposure_of(code + 1) - exposure_of(code - 1)) / 2;
      const double sensor_stddev = full_well * noise.stddev(exposure / full_well);
      const double variance = sensor_stddev * sensor_stddev + slope * slope * code_variance;
      const double w = luminance_weight[channel];
      if (!std::isfinite(exposure) || !std::isfinite(variance)) continue;
      table[static_cast<std::size_t>(code)] = {static_cast<float>(w * exposure), static_cast<float>(w * w * variance)};
    }
  }
}

LogPicture log_picture(const Codes& codes, double h, const Linearizer& linearizer, int cell, int step) {
  const auto averaged = [&](const auto& photo) {
    LogPicture picture;
    picture.cell = cell;
    picture.ln = Image<float>(photo.width() / cell, photo.height() / cell, 1);
    picture.variance = Image<float>(picture.ln.size(), 1);
    for_rows(picture.ln.height(), kRowsPerBlock, [&](int first, int last) {
      for (int y = first; y < last; ++y) {
        for (int x = 0; x < picture.ln.width(); ++x) {
          average_cell(photo.view(), linearizer, x * cell, y * cell, cell, step, h, picture.ln(x, y),
                       picture.variance(x, y));
        }
      }
    });
    return picture;
  };
  return std::visit(averaged, codes);
}

LogPicture tile_picture(const Codes& tiles, double h, const Linearizer& linearizer) {
  constexpr int kFrame = 2;  // farther than the resampling kernel reaches
  constexpr int kSide = PhotoSamples::kTileSide;
  LogPicture picture = log_picture(tiles, h, linearizer, 1, 1);
  for (int y = 0; y < picture.variance.height(); ++y) {
    for (int x = 0; x < picture.variance.width(); ++x) {
      const int dx = x % kSide, dy = y % kSide;
      if (std::min(dx, dy) < kFrame || std::max(dx, dy) >= kSide - kFrame) picture.variance(x, y) = kUnusable;
    }
  }
  return picture;
}

LogPicture halved(const LogPicture& fine) {
  LogPicture half;
  half.cell = fine.cell * 2;
  half.ln = Image<float>(fine.ln.width() / 2, fine.ln.height() / 2, 1);
  half.variance = Image<float>(half.ln.size(), 1);
  for (int y = 0; y < half.ln.height(); ++y) {
    for (int x = 0; x < half.ln.width(); ++x) {
      float precision = 0, sum = 0;
      int usable = 0;
      for (int k = 0; k < 4; ++k) {
        const int u = 2 * x + k % 2, v = 2 * y + k / 2;
        if (!fine.usable(u, v)) continue;
        const float p = 1 / fine.variance(u, v);
        precision += p;
        sum += p * fine.ln(u, v);
        ++usable;
      }
      half.ln(x, y) = usable >= 2 ? sum / precision : 0;
      half.variance(x, y) = usable >= 2 ? 1 / precision : kUnusable;
    }
  }
  return half;
}

LogPicture smoothed(const LogPicture& sharp, int reach) {
  const int width = sharp.ln.width(), height = sharp.ln.height();
  LogPicture soft;
  soft.cell = sharp.cell;
  soft.ln = Image<float>(width, height, 1);
  soft.variance = Image<float>(width, height, 1);
  // The worst variance along each row, then along each column: a square neighbourhood.
  Image<float> worst_of_row(width, height, 1);
  for_rows(height, kRowsPerBlock, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const float* from = sharp.variance.row(y);
      float* to = worst_of_row.row(y);
      std::fill_n(to, width, kUnusable);
      for (int x = reach; x < width - reach; ++x) to[x] = *std::max_element(from + x - reach, from + x + reach + 1);
    }
  });
  for_rows(height, kRowsPerBlock, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      float* to = soft.variance.row(y);
      std::fill_n(to, width, y >= reach && y < height - reach ? 0.0f : kUnusable);
      if (y < reach || y >= height - reach) continue;
      for (int dy = -reach; dy <= reach; ++dy) {
        const float* from = worst_of_row.row(y + dy);
        for (int x = 0; x < width; ++x) to[x] = std::max(to[x], from[x]);
      }
    }
  });
  for_rows(height, kRowsPerBlock, [&](int first, int last) {
    for (int y = std::max(first, 1); y < std::min(last, height - 1); ++y) {
      const float *above = sharp.ln.row(y - 1), *here = sharp.ln.row(y), *below = sharp.ln.row(y + 1);
      for (int x = 1; x < width - 1; ++x) {
        const auto column = [&](int u) { return above[u] + 2 * here[u] + below[u]; };
        soft.ln(x, y) = (column(x - 1) + 2 * column(x) + column(x + 1)) / 16;
      }
    }
  });
  return soft;
}

}  // namespace hdr::internal
