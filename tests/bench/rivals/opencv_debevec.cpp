#include "tests/bench/rivals/opencv_debevec.h"

#include <cmath>
#include <opencv2/core/utility.hpp>
#include <opencv2/photo.hpp>

#include "libhdr/core/error.h"

namespace hdr::bench {
namespace {

/// A view of the codes; OpenCV's BGR order does not matter to what treats channels alike.
cv::Mat mat_of(const Photo& photo) {
  const auto* codes = std::get_if<Image<std::uint8_t>>(&photo.codes);
  HDR_ASSERT(codes != nullptr);
  return {codes->height(), codes->width(), CV_8UC3, const_cast<std::uint8_t*>(codes->row(0)),
          static_cast<std::size_t>(codes->stride())};
}

Response response_of(const cv::Mat& exposures) {
  Response response;
  for (int c = 0; c < 3; ++c) {
    for (int code = 0; code < 256; ++code) {
      response.g[static_cast<std::size_t>(c)].push_back(std::log(exposures.at<cv::Vec3f>(code)[c]));
    }
  }
  return response;
}

/// Code values as OpenCV takes a response: 256 x 1 x 3 exposures.
cv::Mat mat_from_response(const Response& response) {
  cv::Mat exposures(256, 1, CV_32FC3);
  for (int code = 0; code < 256; ++code) {
    for (int c = 0; c < 3; ++c) {
      exposures.at<cv::Vec3f>(code)[c] = static_cast<float>(response.exposure(c, code));
    }
  }
  return exposures;
}

struct Inputs {
  std::vector<cv::Mat> shots;
  std::vector<float> seconds;
};

Inputs inputs_of(const Bracket& bracket, int threads) {
  cv::setNumThreads(threads);
  Inputs inputs;
  for (const Photo& photo : bracket.shots) {
    inputs.shots.push_back(mat_of(photo));
    inputs.seconds.push_back(static_cast<float>(*photo.exposure.seconds));
  }
  return inputs;
}

}  // namespace

Response opencv_debevec_response(const Bracket& bracket, int samples, int threads) {
  Inputs in = inputs_of(bracket, threads);
  cv::Mat exposures;
  cv::createCalibrateDebevec(samples, 10)->process(in.shots, exposures, in.seconds);
  return response_of(exposures);
}

Response opencv_robertson_response(const Bracket& bracket, int rounds, int threads) {
  Inputs in = inputs_of(bracket, threads);
  cv::Mat exposures;
  cv::createCalibrateRobertson(rounds, 0.01f)->process(in.shots, exposures, in.seconds);
  return response_of(exposures);
}

RivalAnswer opencv_merge(const Bracket& bracket, const Response& response, OpenCvMerge method, int threads) {
  Inputs in = inputs_of(bracket, threads);
  const auto map = std::make_shared<cv::Mat>();
  const cv::Mat exposures = mat_from_response(response);
  if (method == OpenCvMerge::kDebevec) {
    cv::createMergeDebevec()->process(in.shots, *map, in.seconds, exposures);
  } else {
    cv::createMergeRobertson()->process(in.shots, *map, in.seconds, exposures);
  }
  return {map, {map->ptr<float>(), map->cols, map->rows, 3, static_cast<std::ptrdiff_t>(map->step1())}, response};
}

namespace {

class OpenCvDebevec : public Rival {
 public:
  std::string name() const override { return "OpenCV Debevec"; }

  RivalAnswer run(const Bracket& bracket, int threads) const override {
    const Response fitted = opencv_debevec_response(bracket, 70, threads);
    return opencv_merge(bracket, fitted, OpenCvMerge::kDebevec, threads);
  }
};

}  // namespace

std::unique_ptr<Rival> opencv_debevec() {
  return std::make_unique<OpenCvDebevec>();
}

}  // namespace hdr::bench
