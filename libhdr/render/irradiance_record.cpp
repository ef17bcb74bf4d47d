// A record is an integral over cells of the hemisphere, cosine-weighted as eq. 9 of the lecture. Its gradients are
// [Ward92]'s: of rotation, how the cosine of each cell changes; of translation, how the borders between cells that see
// different things move, as borders of the nearer one. The second derivative of the same borders tells how far the
// gradients can be trusted [Schwarzhaupt12].
#include "libhdr/render/internal/irradiance_record.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "libhdr/core/color.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/lambert_edge.h"
#include "libhdr/render/internal/latlong_lookup.h"
#include "libhdr/render/internal/points.h"

namespace hdr {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

double brightness(const Rgbf& rgb) {
  return static_cast<double>(luminance(rgb[0], rgb[1], rgb[2]));
}

}  // namespace

// Rings of equal cosine-weighted size, cut into sectors that are about as wide as high.
struct RecordMaker::Cells {
  Cells(const RecordPlace& at, int directions)
      : rings(std::clamp(static_cast<int>(std::lround(std::sqrt(directions / kPi))), 4, 40)),
        sectors(static_cast<int>(std::lround(kPi * rings))) {
    const auto whole = static_cast<std::size_t>((count() + Tracer::kPacket - 1) / Tracer::kPacket * Tracer::kPacket);
    for (auto* array : {&x, &y, &z}) array->assign(whole, 0.0f);
    far.assign(whole, kFar);
    arriving.assign(whole, Rgbf::Zero());
    taken.assign(whole, Rgbf::Zero());
    Vec3f t, b;
    tangents_from_normal(at.normal, t, b);
    tangent = t.cast<double>();
    bitangent = b.cast<double>();
    normal = at.normal.cast<double>();
    for (int sector = 0; sector <= sectors; ++sector) {
      const double phi = 2 * kPi * sector / sectors;
      spokes.push_back(std::cos(phi) * tangent + std::sin(phi) * bitangent);
    }
  }

  int count() const { return rings * sectors; }
  std::size_t index(int ring, int sector) const { return static_cast<std::size_t>(ring * sectors + sector % sectors); }
  // Where borders meet.
  Vec3 corner(int ring, int sector) const {
    const double sine2 = static_cast<double>(ring) / rings;
    return std::sqrt(sine2) * spokes[static_cast<std::size_t>(sector)] + std::sqrt(1 - sine2) * normal;
  }
  // Inside a cell, at shares of its two sides.
  Vec3 inside(int ring, int sector, double u, double v) const {
    const double sine2 = (ring + u) / rings;
    // From the middle of the sector less than .4 radians: sine and cosine within 1e-8.
    const double off = 2 * kPi * (v - 0.5) / sectors, x2 = off * off;
    const double sine = off * (1 - x2 / 6 * (1 - x2 / 20 * (1 - x2 / 42)));
    const double cosine = 1 - x2 / 2 * (1 - x2 / 12 * (1 - x2 / 30 * (1 - x2 / 56)));
    const Vec3& from = spokes[static_cast<std::size_t>(sector)];
    const Vec3& to = spokes[static_cast<std::size_t>(sector) + 1];
    const Vec3 middle = (from + to) / (2 * half_cosine), across = (to - from) / (2 * half_sine);
    return std::sqrt(sine2) * (cosine * middle + sine * across) + std::sqrt(1 - sine2) * normal;
  }

  int rings, sectors;
  double half_cosine = std::cos(kPi / sectors), half_sine = std::sin(kPi / sectors);
  Vec3 tangent, bitangent, normal;
  std::vector<Vec3> spokes;  ///< in the surface, between sectors
  std::vector<float> x, y, z, far;
  std::vector<Rgbf> arriving, taken;  ///< radiance that comes, and what an occluder took
};

void RecordMaker::trace(const RecordPlace& at, std::uint64_t stream, Cells& cells, std::int64_t& rays) const {
  Random random(stream, 7);
  for (int ring = 0; ring < cells.rings; ++ring) {
    for (int sector = 0; sector < cells.sectors; ++sector) {
      const double u = random.uniform(), v = random.uniform();
      const Vec3f dir = cells.inside(ring, sector, u, v).cast<float>();
      const std::size_t k = cells.index(ring, sector);
      cells.x[k] = dir.x(), cells.y[k] = dir.y(), cells.z[k] = dir.z();
    }
  }
  const auto count = static_cast<std::size_t>(cells.count());
  const std::vector<float> origin_x(cells.x.size(), at.position.x()), origin_y(cells.x.size(), at.position.y()),
      origin_z(cells.x.size(), at.position.z());
  const RayArrays towards{origin_x.data(), origin_y.data(), origin_z.data(),
                          cells.x.data(),  cells.y.data(),  cells.z.data()};
  std::vector<Rgbf> reflected(count, Rgbf::Zero());
  if (reflected_ != nullptr) {
    std::vector<std::optional<Hit>> hits(count);
    std::vector<Vec3f> back(count);
    tracer_.intersect(towards, hits, Spread::kWide);
    for (std::size_t k = 0; k < count; ++k) {
      back[k] = -Vec3f(cells.x[k], cells.y[k], cells.z[k]);
      if (hits[k]) cells.far[k] = (hits[k]->position - at.position).norm();
    }
    reflected_->leaving(hits, back, stream, reflected, rays);
  } else {
    tracer_.distances(towards, std::span(cells.far).first(count), Spread::kWide);
  }
  rays += cells.count();
  std::vector<std::int32_t> pixels(cells.x.size());
  latlong_offsets(cells.x.data(), cells.y.data(), cells.z.data(), cells.count(), soft_, pixels.data());
  for (std::size_t k = 0; k < count; ++k) {
    const float* p = soft_.data() + pixels[k];
    const Rgbf sky(p[0], p[1], p[2]);
    cells.arriving[k] = cells.far[k] < kFar ? reflected[k] : sky;
    cells.taken[k] = sky - cells.arriving[k];
  }
}

void RecordMaker::integrate(const Cells& cells, IrradianceRecord& record) {
  const double share = kPi / cells.count();
  Rgb loss = Rgb::Zero();
  Mat3 by_rotation = Mat3::Zero();
  for (int ring = 0; ring < cells.rings; ++ring) {
    // With normals turned by r, a cosine changes by r . (n x dir): as a share of itself by the tangent of dir's angle.
    // 1 / cosine has no variance near the horizon; its mean over the ring is taken instead.
    const double outer = std::sqrt(1 - (ring + 1.0) / cells.rings),
                 inner = std::sqrt(1 - static_cast<double>(ring) / cells.rings);
    const double per_cosine = 2 * cells.rings * (inner - outer);
    for (int sector = 0; sector < cells.sectors; ++sector) {
      const std::size_t k = cells.index(ring, sector);
      const Rgb taken = cells.taken[k].cast<double>();
      loss += share * taken;
      const Vec3 dir(static_cast<double>(cells.x[k]), static_cast<double>(cells.y[k]), static_cast<double>(cells.z[k]));
      by_rotation += share * per_cosine * taken.matrix() * cells.normal.cross(dir).transpose();
    }
  }
  record.loss = loss.cast<float>();
  record.by_rotation = by_rotation.cast<float>();
}

// Sets the gradient of translation; returns the Hessian of luminance.
Mat3 RecordMaker::differentiate(const Cells& cells, IrradianceRecord& record) {
  Mat3 gradient = Mat3::Zero(), hessian = Mat3::Zero();
  struct Corner {
    int ring, sector;
  };
  const auto move = [&](const Rgbf& step, float far, const Corner& from, const Corner& to) {
    if (far == kFar || (step == 0).all()) return;
    const LambertEdge edge = lambert_edge(double{far} * cells.corner(from.ring, from.sector),
                                          double{far} * cells.corner(to.ring, to.sector), cells.normal);
    gradient -= step.cast<double>().matrix() * edge.gradient.transpose();
    hessian -= brightness(step) * edge.hessian;
  };
  const auto border = [&](std::size_t in, std::size_t out, const Corner& from, const Corner& to) {
    move(cells.arriving[in] - cells.arriving[out], std::min(cells.far[in], cells.far[out]), from, to);
  };
  for (int ring = 0; ring < cells.rings; ++ring) {
    for (int sector = 0; sector < cells.sectors; ++sector) {
      const std::size_t k = cells.index(ring, sector);
      const Corner first{ring + 1, sector}, second{ring + 1, sector + 1};
      if (ring + 1 < cells.rings) {
        border(k, cells.index(ring + 1, sector), first, second);
      } else {
        // What stands on the horizon stays there, and is seen under another angle.
        move(-cells.taken[k], cells.far[k], first, second);
      }
      border(k, cells.index(ring, sector + 1), second, {ring, sector + 1});
    }
  }
  record.by_translation = gradient.cast<float>();
  return hessian;
}

// [Schwarzhaupt12] eq. 8: the error of a first-order estimate, integrated over an ellipse in the surface, is kError of
// the irradiance times the area of a pixel when its radii are (4 kError / (pi |lambda|))^(1/4). Measured: with a kError
// of 1 interpolation is off by twice the noise of 64 samples, with .02 records cost more than they tell; a record that
// by chance has seen no occluder speaks for kMostPixels around it.
void RecordMaker::reach(const RecordPlace& at, const Cells& cells, const Mat3& hessian, IrradianceRecord& record) {
  constexpr double kError = 0.05, kLeastPixels = 1, kMostPixels = 20;
  const double footprint = static_cast<double>(at.footprint);
  double most = kMostPixels * footprint;
  // Not farther than to what is nearest: behind it another light begins.
  for (const float far : cells.far) most = std::min(most, static_cast<double>(far));
  double trusted = std::min(1.0, most / (kLeastPixels * footprint));
  most = std::max(most, kLeastPixels * footprint);
  Eigen::Matrix<double, 3, 2> plane;
  plane << cells.tangent, cells.bitangent;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> bends(plane.transpose() * hessian * plane);
  const double irradiance =
      std::max(1e-3 * static_cast<double>(at.irradiance), static_cast<double>(at.irradiance) - brightness(record.loss));
  Mat3 metric = Mat3::Zero();
  double least = most, largest = 0;
  for (int k = 0; k < 2; ++k) {
    const double bend = std::abs(bends.eigenvalues()[k]);
    const double allowed = 4 * kError * footprint * footprint * irradiance / kPi;
    const double wanted = bend * std::pow(most, 4) > allowed ? std::pow(allowed / bend, 0.25) : most;
    const double radius = std::max(wanted, kLeastPixels * footprint);
    trusted = std::min(trusted, wanted / radius);
    const Vec3 axis = plane * bends.eigenvectors().col(k);
    metric += axis * axis.transpose() / (radius * radius);
    least = std::min(least, radius);
    largest = std::max(largest, radius);
  }
  metric += cells.normal * cells.normal.transpose() / (least * least);
  // A gradient that holds less far than the record must reach leads astray.
  record.trusted = static_cast<float>(trusted);
  record.by_translation *= record.trusted;
  record.metric = metric.cast<float>();
  record.radius = static_cast<float>(largest);
}

// A gradient by which what arrives would halve within the record's reach comes from borders that few cells saw, and
// draws dark streaks [Krivanek05b]. All channels alike, so that they keep their colour.
void RecordMaker::limit_gradient(const Cells& cells, IrradianceRecord& record) {
  constexpr float kMostChange = 0.5f;
  Rgbf arriving = Rgbf::Zero();
  for (int k = 0; k < cells.count(); ++k) arriving += cells.arriving[static_cast<std::size_t>(k)];
  arriving *= static_cast<float>(kPi) / static_cast<float>(cells.count());
  float scale = 1;
  for (int c = 0; c < 3; ++c) {
    const float change = record.by_translation.row(c).norm() * record.radius;
    if (change > kMostChange * arriving[c]) scale = std::min(scale, kMostChange * arriving[c] / change);
  }
  record.by_translation *= scale;
}

IrradianceRecord RecordMaker::record(const RecordPlace& at, int directions, std::uint64_t stream,
                                     std::int64_t& rays) const {
  Cells cells(at, directions);
  trace(at, stream, cells, rays);
  IrradianceRecord record;
  record.position = at.position;
  record.normal = at.normal;
  integrate(cells, record);
  reach(at, cells, differentiate(cells, record), record);
  limit_gradient(cells, record);
  return record;
}

void RecordMaker::say_again(IrradianceRecord& record, int directions, std::uint64_t stream, std::int64_t& rays) const {
  Cells cells({record.position, record.normal, 0, 0}, directions);
  trace({record.position, record.normal, 0, 0}, stream, cells, rays);
  integrate(cells, record);
  differentiate(cells, record);
  const float nearest = *std::min_element(cells.far.begin(), cells.far.end());
  record.by_translation *= std::min(record.trusted, nearest / record.radius);
  limit_gradient(cells, record);
}

}  // namespace hdr
