#pragma once
// The inner loop of outline.cpp, on vectors.
#include <cstddef>

namespace hdr::internal {

/// Columns come in multiples of so many, whatever the target's vectors.
inline constexpr int kWhitenedColumns = 16;

/// squares[k] = |W p_k|^2 for the columns p_k of `profiles`, `count` of them, a multiple of kWhitenedColumns. W is a
/// lower triangle of `size` x `size`, row after row; row i of the profiles begins at profiles + i * stride. The same
/// bytes on every target.
void whitened_squares(const float* w, int size, const float* profiles, std::ptrdiff_t stride, int count,
                      float* squares);

}  // namespace hdr::internal
