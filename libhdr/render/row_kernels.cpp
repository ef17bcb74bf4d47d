// Plain loops without a branch, over arrays that are told not to overlap: the compiler makes vectors of them, for each
// kind of vector that Highway knows of.
#include "libhdr/render/internal/row_kernels.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libhdr/render/row_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hdr::internal::HWY_NAMESPACE {

void DotRows(const ConstPlanes& a, const ConstPlanes& b, int count, float* HWY_RESTRICT out) {
  const float *ax = a.x, *ay = a.y, *az = a.z, *bx = b.x, *by = b.y, *bz = b.z;
  for (int k = 0; k < count; ++k) out[k] = ax[k] * bx[k] + ay[k] * by[k] + az[k] * bz[k];
}

bool CosineRows(const ConstPlanes& a, const ConstPlanes& b, int count, float* HWY_RESTRICT cosine,
                std::int32_t* HWY_RESTRICT wanted) {
  const float *ax = a.x, *ay = a.y, *az = a.z, *bx = b.x, *by = b.y, *bz = b.z;
  std::int32_t any = 0;
  for (int k = 0; k < count; ++k) {
    const float dot = ax[k] * bx[k] + ay[k] * by[k] + az[k] * bz[k];
    const float c = dot > 0 ? dot : 0.0f;
    cosine[k] = c;
    wanted[k] = c > 0 ? -1 : 0;
    any |= wanted[k];
  }
  return any != 0;
}

/// Adds weight_of(k) times light wherever it is wanted.
template <class WeightOf>
HWY_INLINE void add_weighted(const std::int32_t* wanted, const WeightOf& weight_of, const ConstPlanes& light, int count,
                             const Planes& out) {
  const float *red = light.x, *green = light.y, *blue = light.z;
  float* HWY_RESTRICT to_red = out.x;
  float* HWY_RESTRICT to_green = out.y;
  float* HWY_RESTRICT to_blue = out.z;
  for (int k = 0; k < count; ++k) {
    const float weight = weight_of(k);
    const float w = wanted[k] != 0 ? weight : 0.0f;
    to_red[k] += w * red[k];
    to_green[k] += w * green[k];
    to_blue[k] += w * blue[k];
  }
}

void AddRow(const std::int32_t* wanted, const float* weight, float scale, const ConstPlanes& light, int count,
            const Planes& out) {
  add_weighted(
      wanted, [=](int k) HWY_ATTR { return scale * weight[k]; }, light, count, out);
}

void AddRowBalanced(const std::int32_t* wanted, const float* cosine, const float* pdf, float of_probe, float of_surface,
                    const ConstPlanes& light, int count, const Planes& out) {
  // What is drawn has a density; a weight without one is of a place that nothing is added to.
  const auto balanced = [=](int k) HWY_ATTR {
    const float density = of_probe * pdf[k] + of_surface * cosine[k];
    return cosine[k] / (density > 1e-30f ? density : 1e-30f);
  };
  add_weighted(wanted, balanced, light, count, out);
}

int OpenRays(const std::int32_t* wanted, std::size_t count, float* HWY_RESTRICT far) {
  constexpr float kFar = std::numeric_limits<float>::infinity();
  std::int32_t opened = 0;
  for (std::size_t k = 0; k < count; ++k) {
    far[k] = wanted[k] != 0 ? kFar : -kFar;
    opened -= wanted[k];
  }
  return opened;
}

void CloseRays(const float* far, std::size_t count, std::int32_t* HWY_RESTRICT wanted) {
  for (std::size_t k = 0; k < count; ++k) wanted[k] = far[k] < 0 ? 0 : -1;
}

}  // namespace hdr::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hdr {
namespace internal {
HWY_EXPORT(DotRows);
HWY_EXPORT(CosineRows);
HWY_EXPORT(AddRow);
HWY_EXPORT(AddRowBalanced);
HWY_EXPORT(OpenRays);
HWY_EXPORT(CloseRays);
}  // namespace internal

void dot_rows(const ConstPlanes& a, const ConstPlanes& b, int count, float* out) {
  HWY_DYNAMIC_DISPATCH(internal::DotRows)(a, b, count, out);
}

bool cosine_rows(const ConstPlanes& a, const ConstPlanes& b, int count, float* cosine, std::int32_t* wanted) {
  return HWY_DYNAMIC_DISPATCH(internal::CosineRows)(a, b, count, cosine, wanted);
}

void add_row(const std::int32_t* wanted, const float* weight, float scale, const ConstPlanes& light, int count,
             const Planes& out) {
  HWY_DYNAMIC_DISPATCH(internal::AddRow)(wanted, weight, scale, light, count, out);
}

void add_row_balanced(const std::int32_t* wanted, const float* cosine, const float* pdf, float of_probe,
                      float of_surface, const ConstPlanes& light, int count, const Planes& out) {
  HWY_DYNAMIC_DISPATCH(internal::AddRowBalanced)(wanted, cosine, pdf, of_probe, of_surface, light, count, out);
}

int open_rays(const std::int32_t* wanted, std::size_t count, float* far) {
  return HWY_DYNAMIC_DISPATCH(internal::OpenRays)(wanted, count, far);
}

void close_rays(const float* far, std::size_t count, std::int32_t* wanted) {
  HWY_DYNAMIC_DISPATCH(internal::CloseRays)(far, count, wanted);
}

}  // namespace hdr
#endif
