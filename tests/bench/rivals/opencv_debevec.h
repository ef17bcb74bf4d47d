#pragma once
#include "tests/bench/rivals/rival.h"

namespace hdr::bench {

/// OpenCV's CalibrateDebevec with 70 samples and lambda 10, its defaults, and MergeDebevec.
std::unique_ptr<Rival> opencv_debevec();

/// CalibrateDebevec and CalibrateRobertson alone; MergeDebevec and MergeRobertson alone, with a response that is given.
Response opencv_debevec_response(const Bracket& bracket, int samples, int threads);
Response opencv_robertson_response(const Bracket& bracket, int rounds, int threads);
enum class OpenCvMerge { kDebevec, kRobertson };
RivalAnswer opencv_merge(const Bracket& bracket, const Response& response, OpenCvMerge method, int threads);

}  // namespace hdr::bench
