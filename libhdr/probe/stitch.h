#pragma once
// Photographs of one place from one point, each of a part of the sphere, as one sphere.
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/radiance.h"
#include "libhdr/probe/projection.h"
#include "libhdr/probe/seam.h"
#include "libhdr/probe/vignetting.h"

namespace hdr {

struct StitchPhoto {
  View<const float> rgb;       ///< linear radiance, three channels
  View<const float> alpha{};   ///< one channel: how much of a pixel counts; empty: all of it
  View<const float> stddev{};  ///< of rgb; empty: not known
  double ceiling = std::numeric_limits<double>::infinity();  ///< a channel that reaches it is clipped
  std::optional<double> fov_degrees{};                       ///< horizontal, a first guess, as EXIF gives it
};

struct StitchOptions {
  bool level = false;       ///< the photographs' horizon becomes the probe's; else the first photograph's axes are
  bool distortion = true;   ///< k1 and k2 of [Brown66] are sought, and kept where the matches call for them
  bool vignetting = false;  ///< sought with the gains; else there is none
};

struct StitchedPhoto {
  bool used = false;
  std::string skipped;  ///< why it was left out
  Rectilinear lens;     ///< one focal length and one distortion in all, in units of the longer side
  Mat3 probe_from_view = Mat3::Identity();
  double gain = 1;         ///< the photograph's radiance times this is the first one's
  double residual_px = 0;  ///< rms distance of its matches from where the solution has them, without the outliers
  int matches = 0;         ///< with the others
};

struct Stitch {
  std::vector<StitchedPhoto> photos;  ///< as many as were given; the first used one sets axes and gain
  Vignetting vignetting;
  double overlap_rms = 0;  ///< of ln(radiance of one / of another) where two show the same, by the median deviation
  bool distorted = false;  ///< whether a distortion was kept
};

/// How the photographs are turned, through which lens, and how bright they are, from their pictures alone, in any
/// order: SIFT features [Lowe04] of all pairs, rotations of pairs by consensus over a range of focal lengths
/// [Fischler81], pairs verified and the largest connected group kept as [Brown07] does, so that photographs that come
/// to lie over each other also look alike there (columns of an arcade match those of its other side), then bundle
/// adjustment [Triggs00] of all rotations, the focal length and the distortion under Cauchy's loss, again with the
/// features that are then near each other; gains by the medians of the overlaps. What does not connect is left out, and
/// says why. Error when no two photographs connect. `names` are for messages, one a photograph.
Stitch solve_stitch(const std::vector<StitchPhoto>& photos, const std::vector<std::string>& names,
                    const StitchOptions& options = {});

/// The sphere as a lat-long of width x width/2. In each direction the photograph that shows it nearest to its middle,
/// faded into the next along the border between them; where they disagree the nearest alone; clipped pixels count only
/// where all are, and there the one with the greatest light: each bounds it from below. With Seam::kCut
/// the photographs' parts are what a graph cut says. `alpha` is 0 where no photograph shows anything, and empty where
/// they show all; `stddev` is there when all have it, propagated through kernels, gains and weights.
RadianceMap merge_stitch(const std::vector<StitchPhoto>& photos, const Stitch& stitch, int width,
                         const Mat3& stitch_from_probe = Mat3::Identity(), Seam seam = Seam::kFeather);

/// What was made up.
struct NadirFill {
  double solid_angle = 0;     ///< sr; 0: there was no hole
  double radius_degrees = 0;  ///< how far from -Y it reached
};

/// Fills the hole around -Y of a lat-long, where alpha is 0 and at most up to the horizon, with the smoothest light
/// that meets its border (the membrane, [Perez03] without guidance). Alpha becomes 1 there.
NadirFill fill_nadir(RadianceMap& latlong);

}  // namespace hdr
