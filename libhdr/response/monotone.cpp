#include "libhdr/response/internal/monotone.h"

#include <algorithm>
#include <cstddef>

namespace hdr {

void make_nondecreasing(std::vector<double>& values) {
  struct Block {
    double mean;
    std::size_t count;
  };
  std::vector<Block> blocks;
  for (const double value : values) {
    blocks.push_back({value, 1});
    while (blocks.size() > 1 && blocks[blocks.size() - 2].mean > blocks.back().mean) {
      const Block last = blocks.back();
      blocks.pop_back();
      Block& pooled = blocks.back();
      const std::size_t count = pooled.count + last.count;
      pooled.mean = (pooled.mean * static_cast<double>(pooled.count) + last.mean * static_cast<double>(last.count)) /
                    static_cast<double>(count);
      pooled.count = count;
    }
  }
  auto out = values.begin();
  for (const Block& block : blocks) out = std::fill_n(out, block.count, block.mean);
}

}  // namespace hdr
