#pragma once
// Loops over the places of a row, on vectors as wide as the machine's. Between them lie millions of rays, so that they
// take a tenth of a render's time and more.
#include <cstddef>
#include <cstdint>

namespace hdr {

/// x, y, z of many directions, or red, green, blue of many lights.
struct ConstPlanes {
  const float *x, *y, *z;
};
struct Planes {
  float *x, *y, *z;
};

/// a.x b.x + a.y b.y + a.z b.z of each place; `out` overlaps neither.
void dot_rows(const ConstPlanes& a, const ConstPlanes& b, int count, float* out);

/// The same, but not below 0; wanted is -1 where it is above 0, and 0 elsewhere. Returns whether any is.
bool cosine_rows(const ConstPlanes& a, const ConstPlanes& b, int count, float* cosine, std::int32_t* wanted);

/// Adds scale times weight times light wherever it is wanted.
void add_row(const std::int32_t* wanted, const float* weight, float scale, const ConstPlanes& light, int count,
             const Planes& out);

/// Adds cosine / (of_probe pdf + of_surface cosine) times light wherever it is wanted: the balance heuristic.
void add_row_balanced(const std::int32_t* wanted, const float* cosine, const float* pdf, float of_probe,
                      float of_surface, const ConstPlanes& light, int count, const Planes& out);

/// Where a ray may end: infinity where it is wanted, and minus infinity elsewhere. Returns how many are wanted.
int open_rays(const std::int32_t* wanted, std::size_t count, float* far);

/// What is in the way has made a far end negative: such rays are wanted no more.
void close_rays(const float* far, std::size_t count, std::int32_t* wanted);

}  // namespace hdr
