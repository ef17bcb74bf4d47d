#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/photo_agreement.h"
#include "libhdr/probe/internal/photo_light.h"
#include "libhdr/probe/internal/photo_links.h"
#include "libhdr/probe/internal/same_pixels.h"
#include "libhdr/probe/stitch.h"

namespace hdr {
namespace {

using namespace internal;

constexpr int kLeastFeatures = 20;
constexpr double kLeastContrast = 0.03;  ///< of detail, ln: with less, noise may be all there is
constexpr double kFovKnown = 0.05;       ///< of ln of the focal length: lenses keep what is written on them within 5 %
constexpr double kFovFound = 0.3;  ///< of one that consensus found: no more than a rail where matches leave it open

/// What is known beforehand of the focal length, in units of the longer side: the middle one of those given.
std::optional<double> expected_focal(const std::vector<StitchPhoto>& photos) {
  std::vector<double> focals;
  for (const StitchPhoto& photo : photos) {
    if (!photo.fov_degrees) continue;
    const Rectilinear camera{photo.rgb.size(), *photo.fov_degrees};
    require_valid(camera);
    focals.push_back(camera.focal_px() / longer_side(photo.rgb.size()));
  }
  if (focals.empty()) return std::nullopt;
  std::sort(focals.begin(), focals.end());
  return focals[focals.size() / 2];
}

/// The solver's state: photographs that cannot take part have no features.
struct Work {
  std::vector<Size> sizes;
  std::vector<Features> features;
  std::vector<PhotoDetail> details;
  std::vector<PhotoLink> links;
  std::set<int> doubted;  ///< photographs of links that others contradict
  Bundle bundle;
  BundleFit fit;
};

void find_features(const std::vector<StitchPhoto>& photos, const std::vector<std::string>& names, Stitch& stitch,
                   Work& work) {
  constexpr int kMost = 2500, kMostTogether = 40000;
  const int most = std::min(kMost, std::max(400, kMostTogether / static_cast<int>(photos.size())));
  for (std::size_t k = 0; k < photos.size(); ++k) {
    work.sizes.push_back(photos[k].rgb.size());
    work.features.emplace_back();
    work.details.emplace_back(photos[k].rgb);
    for (std::size_t j = 0; j < k && stitch.photos[k].skipped.empty(); ++j) {
      if (!same_pixels(photos[j].rgb, photos[k].rgb)) continue;
      stitch.photos[k].skipped = "the same photograph as " + names[j];
    }
    if (!stitch.photos[k].skipped.empty()) continue;
    work.features[k] = photo_features(photos[k].rgb, most);
    const int found = static_cast<int>(work.features[k].px.size());
    if (found >= kLeastFeatures) continue;
    stitch.photos[k].skipped = fmt::format("nothing to recognise: {} features", found);
    work.features[k] = {};
  }
}

void match_all(Work& work) {
  const int count = static_cast<int>(work.features.size());
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) work.links.push_back({a, b, {}});
  }
  for_rows(static_cast<int>(work.links.size()), 1, [&](int first, int) {
    PhotoLink& link = work.links[static_cast<std::size_t>(first)];
    link.matches = match_features(work.features[static_cast<std::size_t>(link.a)],
                                  work.features[static_cast<std::size_t>(link.b)]);
  });
}

Agreement agreement_of(const Work& work, std::size_t a, std::size_t b, const Mat3& a_from_b) {
  const Rectilinear here = camera_of(work.bundle.lens, work.sizes[a]),
                    there = camera_of(work.bundle.lens, work.sizes[b]);
  return work.details[a].agreement(here, work.details[b], there, a_from_b);
}

/// Links whose photographs do not look alike where they should are none.
void look_at_links(Work& work) {
  constexpr double kLeast = 0.3;  // true ones have .7 and more, pictures of other things about 0
  for_rows(static_cast<int>(work.links.size()), 1, [&](int first, int) {
    PhotoLink& link = work.links[static_cast<std::size_t>(first)];
    if (!link.verified) return;
    const Agreement agreement =
        agreement_of(work, static_cast<std::size_t>(link.a), static_cast<std::size_t>(link.b), link.a_from_b);
    link.agreement = agreement.correlation;
    link.verified = agreement.contrast < kLeastContrast || agreement.correlation >= kLeast;
  });
}

/// Links anew, all pairs of the group that show a part of the same, by the features that the solution brings near.
void match_again(const std::vector<int>& members, Work& work) {
  constexpr double kReach = 0.006;  // of the longer side
  constexpr std::size_t kLeast = 6;
  std::vector<PhotoLink> links;
  for (std::size_t i = 0; i < members.size(); ++i) {
    for (std::size_t j = i + 1; j < members.size(); ++j) links.push_back({members[i], members[j], {}});
  }
  for_rows(static_cast<int>(links.size()), 1, [&](int first, int) {
    PhotoLink& link = links[static_cast<std::size_t>(first)];
    const auto a = static_cast<std::size_t>(link.a), b = static_cast<std::size_t>(link.b);
    link.a_from_b = work.bundle.probe_from_photo[a].transpose() * work.bundle.probe_from_photo[b];
    const Rectilinear camera_a = camera_of(work.bundle.lens, work.sizes[a]);
    const Rectilinear camera_b = camera_of(work.bundle.lens, work.sizes[b]);
    std::vector<Vec2> expected;
    for (const Vec2& px : work.features[a].px) {
      const auto ray = camera_a.dir_from_px(px);
      const auto there = ray ? camera_b.px_from_dir(link.a_from_b.transpose() * *ray) : std::nullopt;
      expected.push_back(there.value_or(Vec2::Constant(std::nan(""))));
    }
    link.matches = match_near(work.features[a], work.features[b], expected, kReach * longer_side(work.sizes[b]));
    link.verified = link.matches.size() >= kLeast;
  });
  // The photographs must stay connected.
  const auto old = work.links;
  std::swap(work.links, links);
  if (largest_group(static_cast<int>(work.sizes.size()), work.links).members.size() < members.size()) work.links = old;
}

/// With a distortion where the matches call for it: by Schwarz's criterion [Schwarz78], two more numbers.
bool adjust_lens(bool may_distort, Work& work) {
  constexpr double kReach = 0.003;
  const Bundle before = work.bundle;
  work.bundle.lens.k1 = work.bundle.lens.k2 = 0;
  work.fit = adjust(work.sizes, work.features, work.links, false, kReach, work.bundle);
  if (!may_distort) return false;
  Bundle distorted = before;
  BundleFit fit = adjust(work.sizes, work.features, work.links, true, 0.01, distorted);
  const double variance = std::max(fit.median_off * fit.median_off, 1e-10);
  const double better = (work.fit.cost - fit.cost) / variance;
  if (!(better > 4 * std::log(std::max(2, fit.matches)))) return false;
  work.bundle = distorted;
  work.fit = std::move(fit);
  return true;
}

/// A false link lays photographs over each other that no link connects and that do not look alike there. Of the links
/// of the tree on the way between those the weakest, unless nothing contradicts or that is too strong to be doubted.
std::optional<std::size_t> contradicted(const LinkedGroup& group, const std::vector<PhotoLink>& links,
                                        const Work& work) {
  // Of what overlaps by little; true pairs have .79 and more, false ones .37 to .83. The more two photographs share
  // that no features link, the more alike they must look.
  const auto unlike = [](double share) { return 0.6 + 0.5 * std::min(share, 0.5); };
  constexpr double kLeastShare = 0.1;
  const double undoubted = std::log(100.0) - std::log(1 - 0.9 * 0.9);
  std::set<std::pair<int, int>> linked;
  for (const PhotoLink& link : links) {
    if (link.verified) linked.emplace(link.a, link.b);
  }
  struct Overlap {
    std::size_t a, b;
    Agreement agreement;
  };
  std::vector<Overlap> overlaps;
  for (const int a : group.members) {
    for (const int b : group.members) {
      if (a >= b || linked.contains({a, b})) continue;
      overlaps.push_back({static_cast<std::size_t>(a), static_cast<std::size_t>(b), {}});
    }
  }
  for_rows(static_cast<int>(overlaps.size()), 1, [&](int first, int) {
    Overlap& o = overlaps[static_cast<std::size_t>(first)];
    const std::vector<Mat3>& turn = work.bundle.probe_from_photo;
    o.agreement = agreement_of(work, o.a, o.b, turn[o.a].transpose() * turn[o.b]);
  });
  std::erase_if(overlaps, [&](const Overlap& o) {
    return o.agreement.share < kLeastShare || o.agreement.contrast < kLeastContrast ||
           o.agreement.correlation > unlike(o.agreement.share);
  });
  std::stable_sort(overlaps.begin(), overlaps.end(), [](const Overlap& p, const Overlap& q) {
    return p.agreement.correlation < q.agreement.correlation;
  });
  for (const Overlap& o : overlaps) {
    const std::size_t weakest = weakest_between(static_cast<int>(o.a), static_cast<int>(o.b), group.tree, links);
    if (strength_of(links[weakest]) < undoubted) return weakest;
  }
  return std::nullopt;
}

[[noreturn]] void throw_unconnected(const std::vector<std::string>& names, const Stitch& stitch) {
  std::size_t usable = 0;
  std::string reason;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (stitch.photos[k].skipped.empty()) {
      ++usable;
    } else if (reason.empty()) {
      reason = " (" + names[k] + ": " + stitch.photos[k].skipped + ")";
    }
  }
  if (usable < 2) {
    throw Error(fmt::format("{}: {} of {} photographs can be stitched{}; give two or more that overlap by a third",
                            names.front(), usable, names.size(), reason));
  }
  throw Error(fmt::format(
      "{}: no two of {} photographs show enough of the same{}; let neighbours overlap by a third, or give --fov",
      names.front(), names.size(), reason));
}

/// The largest group that nothing contradicts, adjusted.
LinkedGroup connected(bool may_distort, const std::vector<std::string>& names, Stitch& stitch, Work& work) {
  const SharedLens lens = work.bundle.lens;
  std::vector<PhotoLink> links = work.links;
  for (;;) {
    work.links = links;
    work.bundle.lens = lens;
    const LinkedGroup group = largest_group(static_cast<int>(names.size()), work.links);
    if (group.members.size() < 2) throw_unconnected(names, stitch);
    for (PhotoLink& link : work.links) {
      const auto in_group = [&](int k) { return std::binary_search(group.members.begin(), group.members.end(), k); };
      link.verified &= in_group(link.a) && in_group(link.b);
    }
    const std::vector<PhotoLink> agreeing = work.links;
    work.bundle.probe_from_photo = group.first_from_photo;
    work.bundle.fixed = group.members.front();
    adjust(work.sizes, work.features, work.links, may_distort, 0.03, work.bundle);
    match_again(group.members, work);
    stitch.distorted = adjust_lens(may_distort, work);
    const auto wrong = contradicted(group, agreeing, work);
    if (!wrong) return group;
    links[*wrong].verified = false;
    for (const int k : {links[*wrong].a, links[*wrong].b}) work.doubted.insert(k);
  }
}

/// The up vector is at right angles to all photographs' horizontals, which cameras that are not tilted sideways keep
/// [Brown07] section 5. The heading stays the first one's.
Mat3 levelled_from_first(const Stitch& stitch) {
  Mat3 covariance = Mat3::Zero();
  Vec3 about_up = Vec3::Zero(), ahead = Vec3::UnitZ();
  bool first = true;
  for (const StitchedPhoto& photo : stitch.photos) {
    if (!photo.used) continue;
    const Vec3 x = photo.probe_from_view.col(0);
    covariance += x * x.transpose();
    about_up += photo.probe_from_view.col(1);
    if (first) ahead = photo.probe_from_view.col(2);
    first = false;
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(covariance);
  // Photographs that all look the same way leave the tilt open: then theirs is taken.
  constexpr double kSpread = 0.02;
  Vec3 up = eigen.eigenvectors().col(0);
  if (eigen.eigenvalues()[1] < kSpread * eigen.eigenvalues()[2]) up = about_up.normalized();
  if (up.dot(about_up) < 0) up = -up;
  Vec3 forward = ahead - up.dot(ahead) * up;
  if (forward.norm() < 1e-3) forward = up.unitOrthogonal();
  forward.normalize();
  Mat3 first_from_level;
  first_from_level << up.cross(forward), up, forward;
  return first_from_level.transpose();
}

void fill_in(const LinkedGroup& group, const Work& work, Stitch& stitch) {
  for (const int member : group.members) {
    const auto k = static_cast<std::size_t>(member);
    StitchedPhoto& photo = stitch.photos[k];
    photo.used = true;
    photo.lens = camera_of(work.bundle.lens, work.sizes[k]);
    photo.probe_from_view = work.bundle.probe_from_photo[k];
    std::vector<double> off;
    for (std::size_t l = 0; l < work.links.size(); ++l) {
      if (!work.links[l].verified || (work.links[l].a != member && work.links[l].b != member)) continue;
      off.insert(off.end(), work.fit.off_px[l].begin(), work.fit.off_px[l].end());
    }
    photo.matches = static_cast<int>(off.size());
    if (off.empty()) continue;
    std::sort(off.begin(), off.end());
    const double limit = 3 * off[off.size() / 2];
    double squares = 0;
    int inliers = 0;
    for (const double o : off) {
      if (o > limit) break;
      squares += o * o;
      ++inliers;
    }
    photo.residual_px = std::sqrt(squares / inliers);
  }
}

}  // namespace

Stitch solve_stitch(const std::vector<StitchPhoto>& photos, const std::vector<std::string>& names,
                    const StitchOptions& options) {
  HDR_ASSERT(photos.size() == names.size());
  if (photos.size() < 2) {
    throw Error(fmt::format("{}: one photograph is no panorama; give two or more that overlap by a third",
                            names.empty() ? std::string("stitch") : names.front()));
  }
  Stitch stitch;
  stitch.photos.resize(photos.size());
  Work work;
  find_features(photos, names, stitch, work);
  match_all(work);
  const auto expected = expected_focal(photos);
  const FocalRange range =
      expected ? FocalRange{*expected * std::exp(-2 * kFovKnown), *expected * std::exp(2 * kFovKnown)} : kAnyFocal;
  work.bundle.lens.focal = link_photos(work.sizes, work.features, range, work.links);
  look_at_links(work);
  work.bundle.expected_focal = expected.value_or(work.bundle.lens.focal);
  work.bundle.focal_deviation = expected ? kFovKnown : kFovFound;
  const LinkedGroup group = connected(options.distortion, names, stitch, work);
  fill_in(group, work, stitch);
  for (std::size_t k = 0; k < photos.size(); ++k) {
    StitchedPhoto& photo = stitch.photos[k];
    if (photo.used || !photo.skipped.empty()) continue;
    photo.skipped = work.doubted.contains(static_cast<int>(k))
                        ? "looks like more than one place; let neighbours overlap by a third"
                        : "shows nothing that the others show";
  }
  fit_light(photos, options.vignetting, stitch);
  if (options.level) {
    const Mat3 level = levelled_from_first(stitch);
    for (StitchedPhoto& photo : stitch.photos) {
      if (photo.used) photo.probe_from_view = level * photo.probe_from_view;
    }
  }
  return stitch;
}

}  // namespace hdr
