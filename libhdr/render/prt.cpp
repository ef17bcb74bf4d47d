#include "libhdr/render/prt.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/render/internal/points.h"
#include "libhdr/render/tracer.h"

namespace hdr {
namespace {

int count_of(int degree) {
  return (degree + 1) * (degree + 1);
}

Vec3f cosine_weighted(const Vec2& u, const Vec3f& normal) {
  Vec3f t, b;
  tangents_from_normal(normal, t, b);
  const double r = std::sqrt(u.x()), phi = 2 * kPi * u.y();
  return static_cast<float>(r * std::cos(phi)) * t + static_cast<float>(r * std::sin(phi)) * b +
         static_cast<float>(std::sqrt(1 - u.x())) * normal;
}

// A_l of every coefficient, E_lm = A_l L_lm [Ramamoorthi01]: from the irradiance of a light that is Y_l0 alone.
Eigen::VectorXd band_factors(int degree) {
  Eigen::VectorXd factors(count_of(degree));
  for (int l = 0; l <= degree; ++l) {
    Sh one{l, std::vector<Rgb>(static_cast<std::size_t>(count_of(l)), Rgb::Zero())};
    one.coefficients[static_cast<std::size_t>(l * (l + 1))] = Rgb::Ones();
    factors.segment(l * l, 2 * l + 1).setConstant(irradiance(one, Vec3::UnitZ())[0] / evaluate(one, Vec3::UnitZ())[0]);
  }
  return factors;
}

// T = what all of the hemisphere would give, less what is in the way: pi / N sum of Y(w) over the rays that hit.
void transfer_of_vertex(const Tracer& tracer, const Mesh& mesh, std::size_t vertex, const TransferOptions& options,
                        std::uint64_t stream, const Eigen::VectorXd& bands, float lift, Transfer& out) {
  const Vec3f normal = mesh.normals[vertex], origin = mesh.positions[vertex] + lift * normal;
  Eigen::VectorXd y(count_of(options.degree)), blocked = Eigen::VectorXd::Zero(y.size());
  for (int k = 0; k < options.samples; ++k) {
    const Vec3f dir = cosine_weighted(sobol_point(static_cast<std::uint32_t>(k), stream), normal);
    if (!tracer.occluded(origin, dir)) continue;
    sh_basis(dir.cast<double>().normalized(), options.degree, y.data());
    blocked += y;
  }
  sh_basis(normal.cast<double>().normalized(), options.degree, y.data());
  const Eigen::VectorXd open = bands.cwiseProduct(y);
  out.vectors.row(static_cast<Eigen::Index>(vertex)) =
      (open - blocked * (kPi / options.samples)).transpose().cast<float>();
}

}  // namespace

// Above the facets around it by more than rounding, by less than anything one looks at.
float transfer_lift(const Mesh& mesh) {
  float largest = 1e-6f;
  for (const Vec3f& p : mesh.positions) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  return 2e-4f * largest;
}

std::vector<Transfer> diffuse_transfer(const Scene& scene, const TransferOptions& options) {
  HDR_ASSERT(options.degree >= 0 && options.degree <= kMaxShDegree && options.samples > 0);
  const Tracer tracer(scene);
  const Eigen::VectorXd bands = band_factors(options.degree);
  std::vector<Transfer> result;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    HDR_ASSERT(mesh.normals.size() == mesh.positions.size());
    Transfer transfer{options.degree, {}};
    const auto vertices = static_cast<int>(mesh.positions.size());
    transfer.vectors.resize(vertices, count_of(options.degree));
    const float lift = transfer_lift(mesh);
    std::atomic<int> done = 0;
    for_rows(vertices, 64, [&](int first, int last) {
      for (int v = first; v < last; ++v) {
        const auto vertex = static_cast<std::size_t>(v);
        transfer_of_vertex(tracer, mesh, vertex, options, address(options.seed, vertex, m, 7), bands, lift, transfer);
      }
      done += last - first;
      if (options.progress) {
        options.progress((static_cast<double>(m) + static_cast<double>(done) / vertices) /
                         static_cast<double>(scene.meshes.size()));
      }
    });
    result.push_back(std::move(transfer));
  }
  return result;
}

Eigen::Matrix<float, Eigen::Dynamic, 3> relit(const Transfer& transfer, const Sh& light) {
  const auto count =
      std::min<Eigen::Index>(transfer.vectors.cols(), static_cast<Eigen::Index>(light.coefficients.size()));
  Eigen::Matrix<float, Eigen::Dynamic, 3> coefficients(count, 3);
  for (Eigen::Index k = 0; k < count; ++k)
    coefficients.row(k) = light.coefficients[static_cast<std::size_t>(k)].matrix().transpose().cast<float>();
  return transfer.vectors.leftCols(count) * coefficients;
}

}  // namespace hdr
