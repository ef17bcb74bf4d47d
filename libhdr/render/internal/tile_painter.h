#pragma once
// A tile of the picture: its camera rays in packets, then the light of all that they met together.
#include <cstdint>
#include <memory>
#include <vector>

#include "libhdr/render/internal/camera_rays.h"
#include "libhdr/render/internal/film.h"
#include "libhdr/render/internal/gloss.h"
#include "libhdr/render/internal/integrator.h"
#include "libhdr/render/internal/interreflection.h"

namespace hdr {

/// What painting took.
struct Tally {
  std::int64_t rays = 0;
  std::int64_t directions = 0;  ///< sum over pixels
  std::int64_t backs = 0;       ///< tiles that saw a surface from behind

  Tally& operator+=(const Tally& other) {
    rays += other.rays;
    directions += other.directions;
    backs += other.backs;
    return *this;
  }
};

class TilePainter {
 public:
  static constexpr int kTile = 8;  ///< pixels along each side: DirectionPool::kVariants in all

  TilePainter(const Setting& setting, RenderMethod method);

  int tiles() const { return across_ * down_; }
  /// Once a pass, before its tiles. Returns the rays it took.
  std::int64_t begin(const Pass& pass);
  /// Adds an estimate of the pass to those pixels of the tile that are not yet `done` (empty: all). From any thread.
  void paint(int tile, const Pass& pass, const std::vector<std::uint8_t>& done, Film& film, Tally& tally) const;
  std::vector<Vec2f> record_points() const { return integrator_->record_points(); }
  int most_directions() const { return integrator_->most_directions(); }
  bool exact() const { return integrator_->exact() && !has_gloss_; }

 private:
  struct Workspace;
  void find_pixels(int tile, const std::vector<std::uint8_t>& done, Workspace& work) const;
  void trace(const Pass& pass, int camera_ray, Workspace& work, std::int64_t& rays) const;
  void follow(const Vec3f& dir, int place, std::optional<Hit>& hit, Workspace& work, std::int64_t& rays) const;
  void collect(const Pass& pass, Workspace& work, Film& film) const;

  const Setting& setting_;
  Size size_;
  int across_, down_;
  CameraRays camera_;
  std::unique_ptr<Integrator> integrator_;
  std::unique_ptr<Interreflection> interreflection_;
  Gloss gloss_;
  bool has_gloss_;
};

}  // namespace hdr
