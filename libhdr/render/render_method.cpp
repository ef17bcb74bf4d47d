// Names of methods, and the integrator of each.
#include <algorithm>
#include <array>

#include "libhdr/render/internal/integrator.h"

namespace hdr {
namespace {

struct NamedMethod {
  const char* name;
  RenderMethod method;
};
constexpr NamedMethod kMethods[] = {
    {"auto", RenderMethod::kAuto},
    {"mc", RenderMethod::kMc},
    {"pixels", RenderMethod::kPixels},
    {"importance", RenderMethod::kImportance},
    {"structured", RenderMethod::kStructured},
    {"mis", RenderMethod::kMis},
    {"cache", RenderMethod::kCache},
    {"ao", RenderMethod::kAo},
    {"sh", RenderMethod::kSh},
    {"sh-ao", RenderMethod::kShAo},
    {"mean-ao", RenderMethod::kMeanAo},
    {"prt", RenderMethod::kPrt},
};

}  // namespace

std::optional<RenderMethod> render_method_from_name(const std::string& name) {
  for (const NamedMethod& known : kMethods)
    if (name == known.name) return known.method;
  return std::nullopt;
}

const char* name_of(RenderMethod method) {
  const auto* known =
      std::find_if(std::begin(kMethods), std::end(kMethods), [&](auto& m) { return m.method == method; });
  HDR_ASSERT(known != std::end(kMethods));
  return known->name;
}

bool reflects_light(RenderMethod method) {
  constexpr RenderMethod kThese[] = {RenderMethod::kAuto,       RenderMethod::kMc,         RenderMethod::kPixels,
                                     RenderMethod::kImportance, RenderMethod::kStructured, RenderMethod::kMis,
                                     RenderMethod::kCache};
  return std::find(std::begin(kThese), std::end(kThese), method) != std::end(kThese);
}

std::unique_ptr<Integrator> make_integrator(RenderMethod method, const Setting& setting) {
  switch (method) {
    case RenderMethod::kMc:
      return make_mc(setting);
    case RenderMethod::kPixels:
      return make_pixels(setting);
    case RenderMethod::kImportance:
      return make_mis(setting, 1);
    case RenderMethod::kStructured:
      return make_structured(setting);
    case RenderMethod::kMis:
      return make_mis(setting, 0.5);
    case RenderMethod::kCache:
      return make_cache(setting);
    case RenderMethod::kAo:
      return make_ao(setting);
    case RenderMethod::kSh:
      return make_sh(setting);
    case RenderMethod::kShAo:
      return make_occluded_sh(setting);
    case RenderMethod::kMeanAo:
      return make_occluded_mean(setting);
    case RenderMethod::kPrt:
      return make_prt(setting);
    case RenderMethod::kAuto:
      break;
  }
  HDR_ASSERT(!"a method that has been chosen");
  return nullptr;
}

}  // namespace hdr
