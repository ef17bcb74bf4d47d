#include "tests/bench/rivals/rival.h"

#ifdef HDR_RIVAL_OPENCV
#include "tests/bench/rivals/opencv_align_mtb.h"
#include "tests/bench/rivals/opencv_debevec.h"
#endif

namespace hdr::bench {

std::vector<std::unique_ptr<Rival>> available_rivals() {
  std::vector<std::unique_ptr<Rival>> rivals;
#ifdef HDR_RIVAL_OPENCV
  rivals.push_back(opencv_debevec());
#endif
  return rivals;
}

std::vector<std::unique_ptr<AlignRival>> available_align_rivals() {
  std::vector<std::unique_ptr<AlignRival>> rivals;
#ifdef HDR_RIVAL_OPENCV
  rivals.push_back(opencv_align_mtb());
#endif
  return rivals;
}

}  // namespace hdr::bench
