#pragma once
// What the camera rays of a tile met, and what light they receive, side by side: the rays that go on from there are
// traced in packets.
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "libhdr/render/tracer.h"

namespace hdr {

/// Places are numbered: all of the first camera ray of each pixel, padded to whole packets, then all of the second...
/// A place whose ray met nothing that scatters light has no hit, and a normal of 0.
struct Surfaces {
  int places = 0;  ///< of one camera ray; a multiple of Tracer::kPacket
  int camera_rays = 0;
  std::uint32_t tile = 0;
  std::vector<float> x, y, z;                       ///< positions
  std::vector<float> normal_x, normal_y, normal_z;  ///< of diffuse surfaces; elsewhere 0: no light is asked for
  std::vector<float> tangent_x, tangent_y, tangent_z, bitangent_x, bitangent_y, bitangent_z;
  std::vector<std::int32_t> diffuse;  ///< -1 at diffuse surfaces, 0 elsewhere
  std::vector<std::optional<Hit>> hits;
  std::vector<Vec3f> viewers;        ///< unit, towards where the surface is seen from
  std::vector<std::int32_t> glossy;  ///< places of materials that are not diffuse
  bool fronts = true;                ///< every hit is seen from its outside
  bool any_diffuse = false;

  int count() const { return places * camera_rays; }
  void resize(int places_of_one, int rays);
  /// `plain`: as a diffuse surface, whatever its material.
  void set(int place, const Hit& hit, const Vec3f& viewer, bool plain);
};

/// Of a surface that is taken for a diffuse one, whatever its material.
Rgbf diffuse_albedo(const Scene& scene, const Hit& hit);

/// Red, green and blue of every place.
struct Light {
  std::array<std::vector<float>, 3> rgb;
  std::vector<float> doubt;  ///< luminance that it may be off by in all passes alike; empty: by nothing

  void reset(int places) {
    for (auto& channel : rgb) channel.assign(static_cast<std::size_t>(places), 0.0f);
    doubt.clear();
  }
  Rgbf of(int place) const {
    const auto k = static_cast<std::size_t>(place);
    return {rgb[0][k], rgb[1][k], rgb[2][k]};
  }
  void add(int place, const Rgbf& value) {
    for (std::size_t c = 0; c < 3; ++c) rgb[c][static_cast<std::size_t>(place)] += value[static_cast<int>(c)];
  }
};

}  // namespace hdr
