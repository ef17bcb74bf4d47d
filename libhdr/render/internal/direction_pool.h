#pragma once
// Directions that all pixels of a pass choose from: a row for each stratum, in it as many variants as a tile has
// pixels. Every pixel takes its own variant of each row, so its directions are jittered independently of its
// neighbours' [Keller01]; a row's variants are themselves well spread in the stratum. Drawn anew each pass.
#include <cstdint>
#include <vector>

#include "libhdr/light/environment.h"
#include "libhdr/render/tracer.h"

namespace hdr {

class LightStrata;

struct DirectionPool {
  static constexpr int kVariants = 64;  ///< of a set: the pixels of a tile

  int rows = 0, sets = 1;
  std::vector<float> x, y, z;           ///< unit directions: of the world, or of a surface whose normal is z
  std::vector<float> red, green, blue;  ///< what arrives from there; empty in a surface's frame
  std::vector<float> pdf;               ///< per steradian
  std::vector<float> u, v;              ///< what the directions were made from

  DirectionPool() = default;
  DirectionPool(int rows_wanted, bool of_world);

  /// Where the variants of a row begin that the places of a tile take: index of the first of kVariants.
  std::size_t begin(int row, std::uint32_t tile) const { return block(row, tile) * kVariants; }
  /// Of those, in the world.
  Spread spread(int row, std::uint32_t tile) const { return beams_[block(row, tile)] ? Spread::kBeam : Spread::kWide; }
  void find_beams();  ///< once the directions are there

 private:
  std::size_t block(int row, std::uint32_t tile) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(sets) + tile % static_cast<std::uint32_t>(sets);
  }
  std::vector<std::uint8_t> beams_;
};

/// Cosine-weighted about z, eq. 9 of the lecture: row k is stratum k of M x N.
DirectionPool stratified_hemisphere(int rows, std::uint64_t stream);

/// Rows as parts of the unit square in turn, or each variant's points in an order of its own: then a row is as good as
/// all of them.
enum class RowOrder { kParts, kByChance };

/// Cosine-weighted about z, each variant a slice of Owen-scrambled Sobol points.
DirectionPool sobol_hemisphere(int rows, std::uint64_t stream, RowOrder order = RowOrder::kParts);

/// From the probe, likewise.
DirectionPool sobol_environment(const Environment& light, int rows, std::uint64_t stream,
                                RowOrder order = RowOrder::kParts);

/// A row for each stratum, drawn by luminance in it. red, green and blue are what a surface that faces there receives
/// from the whole stratum if all of it had the colour of this one direction: expected value, the stratum's.
DirectionPool stratified_light(const LightStrata& strata, std::uint64_t stream);

}  // namespace hdr
