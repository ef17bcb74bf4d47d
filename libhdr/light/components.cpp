#include "libhdr/light/internal/components.h"

#include "libhdr/core/error.h"

namespace hdr {

std::vector<std::vector<std::int32_t>> connected_components(const std::vector<std::uint8_t>& inside, Size size) {
  HDR_ASSERT(inside.size() == static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
  std::vector<std::uint8_t> open = inside;
  std::vector<std::vector<std::int32_t>> components;
  std::vector<std::int32_t> component;
  const auto take = [&](int x, int y) {
    const std::int32_t cell = y * size.width + x;
    if (!open[static_cast<std::size_t>(cell)]) return;
    open[static_cast<std::size_t>(cell)] = 0;
    component.push_back(cell);
  };
  for (int start = 0; start < static_cast<int>(inside.size()); ++start) {
    if (!open[static_cast<std::size_t>(start)]) continue;
    component.clear();
    take(start % size.width, start / size.width);
    bool pole_taken[2] = {false, false};
    for (std::size_t k = 0; k < component.size(); ++k) {  // grows as it goes
      const int x = component[k] % size.width, y = component[k] / size.width;
      for (int dy = -1; dy <= 1; ++dy) {
        if (y + dy < 0 || y + dy >= size.height) continue;
        for (int dx = -1; dx <= 1; ++dx) take((x + dx + size.width) % size.width, y + dy);
      }
      for (const int pole : {0, 1}) {
        if (y != (pole == 0 ? 0 : size.height - 1) || pole_taken[pole]) continue;
        pole_taken[pole] = true;
        for (int around = 0; around < size.width; ++around) take(around, y);
      }
    }
    components.push_back(component);
  }
  return components;
}

}  // namespace hdr
