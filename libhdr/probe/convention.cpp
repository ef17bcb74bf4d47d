#include "libhdr/probe/convention.h"

#include <array>
#include <utility>

namespace hdr {
namespace {

constexpr std::array<std::pair<const char*, Convention>, 10> kNames = {{{"openexr", Convention::kOpenExr},
                                                                        {"blender", Convention::kBlender},
                                                                        {"threejs", Convention::kThreeJs},
                                                                        {"pbrt", Convention::kPbrt},
                                                                        {"alicevision", Convention::kAliceVision},
                                                                        {"hdrtoolbox", Convention::kHdrToolbox},
                                                                        {"opengl", Convention::kOpenGl},
                                                                        {"usd", Convention::kOpenExr},
                                                                        {"mitsuba", Convention::kOpenExr},
                                                                        {"gltf", Convention::kThreeJs}}};

/// The turn about +Y that brings `centre` to +Z; exact for the axes.
Mat3 turn_to_z(const Vec3& centre) {
  Mat3 m;
  m.row(0) = Vec3::UnitY().cross(centre).transpose();
  m.row(1) = Vec3::UnitY().transpose();
  m.row(2) = centre.transpose();
  return m;
}

}  // namespace

const char* name_of(Convention convention) {
  for (const auto& [name, value] : kNames) {
    if (value == convention) return name;
  }
  return kNames[0].first;
}

std::optional<Convention> convention_from_name(const std::string& name) {
  for (const auto& [known, value] : kNames) {
    if (name == known) return value;
  }
  return std::nullopt;
}

Mat3 openexr_from_convention(Convention convention) {
  switch (convention) {
    case Convention::kBlender:
    case Convention::kThreeJs:
      return turn_to_z(Vec3::UnitX());
    case Convention::kPbrt:
      return turn_to_z(-Vec3::UnitX());
    case Convention::kHdrToolbox:
      return turn_to_z(-Vec3::UnitZ());
    default:
      return Mat3::Identity();
  }
}

}  // namespace hdr
