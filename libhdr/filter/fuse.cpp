#include "libhdr/filter/fuse.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libhdr/core/error.h"
#include "libhdr/core/internal/opencv.h"
#include "libhdr/core/parallel.h"

namespace hdr {
namespace {

/// Codes as fractions of the full scale.
cv::Mat picture_of(const Photo& photo) {
  cv::Mat picture(photo.height(), photo.width(), CV_32FC3);
  std::visit(
      [&](const auto& codes) {
        for (int y = 0; y < codes.height(); ++y) {
          float* row = picture.ptr<float>(y);
          for (std::size_t k = 0; k < codes.row_samples(); ++k) {
            row[k] = static_cast<float>(codes.row(y)[k]) / static_cast<float>(photo.max_code());
          }
        }
      },
      photo.codes);
  return picture;
}

/// [Mertens07] section 3.1: W = C^wC S^wS E^wE of each pixel.
cv::Mat quality_of(const cv::Mat& picture, const FuseOptions& options) {
  cv::Mat grey, contrast, quality(picture.size(), CV_32FC1);
  cv::cvtColor(picture, grey, cv::COLOR_RGB2GRAY);
  cv::Laplacian(grey, contrast, CV_32F);
  for_rows(picture.rows, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const float *p = picture.ptr<float>(y), *c = contrast.ptr<float>(y);
      float* out = quality.ptr<float>(y);
      for (int x = 0; x < picture.cols; ++x, p += 3) {
        const double mean = (p[0] + p[1] + p[2]) / 3.0;
        double variance = 0, exposedness = 1;
        for (int k = 0; k < 3; ++k) {
          constexpr double kMiddle = 0.5, kSigma = 0.2;
          variance += (p[k] - mean) * (p[k] - mean) / 3;
          exposedness *= std::exp(-(p[k] - kMiddle) * (p[k] - kMiddle) / (2 * kSigma * kSigma));
        }
        // A floor, so that a pixel which is poor in every shot becomes their mean.
        constexpr double kFloor = 1e-12;
        out[x] = static_cast<float>(std::pow(std::abs(c[x]), options.contrast) *
                                        std::pow(std::sqrt(variance), options.saturation) *
                                        std::pow(exposedness, options.exposedness) +
                                    kFloor);
      }
    }
  });
  return quality;
}

std::vector<cv::Mat> gaussian_pyramid(const cv::Mat& image, int levels) {
  std::vector<cv::Mat> pyramid = {image};
  for (int k = 1; k < levels; ++k) {
    cv::Mat smaller;
    cv::pyrDown(pyramid.back(), smaller);
    pyramid.push_back(smaller);
  }
  return pyramid;
}

std::vector<cv::Mat> laplacian_pyramid(const cv::Mat& image, int levels) {
  std::vector<cv::Mat> pyramid = gaussian_pyramid(image, levels);
  for (std::size_t k = 0; k + 1 < pyramid.size(); ++k) {
    cv::Mat larger;
    cv::pyrUp(pyramid[k + 1], larger, pyramid[k].size());
    pyramid[k] = pyramid[k] - larger;
  }
  return pyramid;
}

/// sum += weight * values; three channels weighted by one.
void add_weighted(const cv::Mat& values, const cv::Mat& weight, cv::Mat& sum) {
  for_rows(values.rows, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const float *v = values.ptr<float>(y), *w = weight.ptr<float>(y);
      float* s = sum.ptr<float>(y);
      for (int x = 0; x < 3 * values.cols; ++x) s[x] += w[x / 3] * v[x];
    }
  });
}

void require_size(const Photo& photo, Size size) {
  if (photo.size() == size) return;
  throw Error(photo.path.string() + ": has another size than the first shot; fuse shots of one size");
}

}  // namespace

Image<float> fuse(int count, const std::function<Photo(int)>& shot, const FuseOptions& options) {
  if (count < 1) throw Error("no shots to fuse; name photographs");
  Size size;
  cv::Mat total;
  for (int k = 0; k < count; ++k) {
    const Photo photo = shot(k);
    if (k == 0) size = photo.size();
    require_size(photo, size);
    const cv::Mat quality = quality_of(picture_of(photo), options);
    total = total.empty() ? quality : total + quality;
  }
  // Down to a few pixels: the lowest level is a mean of everything.
  const int levels = 1 + static_cast<int>(std::log2(std::min(size.width, size.height)));
  std::vector<cv::Mat> fused;
  for (int k = 0; k < count; ++k) {
    const cv::Mat picture = picture_of(shot(k));
    const cv::Mat weight = quality_of(picture, options) / total;
    const std::vector<cv::Mat> weights = gaussian_pyramid(weight, levels), details = laplacian_pyramid(picture, levels);
    for (std::size_t level = 0; level < details.size(); ++level) {
      if (k == 0) fused.push_back(cv::Mat::zeros(details[level].size(), CV_32FC3));
      add_weighted(details[level], weights[level], fused[level]);
    }
  }
  for (std::size_t level = fused.size() - 1; level > 0; --level) {
    cv::Mat larger;
    cv::pyrUp(fused[level], larger, fused[level - 1].size());
    fused[level - 1] += larger;
  }
  Image<float> out(size, 3);
  for (int y = 0; y < size.height; ++y) {
    const float* from = fused[0].ptr<float>(y);
    for (int x = 0; x < 3 * size.width; ++x) out.row(y)[x] = std::clamp(from[x], 0.0f, 1.0f);
  }
  return out;
}

}  // namespace hdr
