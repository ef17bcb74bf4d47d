// Precomputed radiance transfer [Sloan02]: irradiance of vertices, shadows included, interpolated.
#include <algorithm>

#include "libhdr/render/internal/integrator.h"

namespace hdr {
namespace {

class TransferIrradiance : public Integrator {
 public:
  explicit TransferIrradiance(const Setting& setting) : scene_(setting.scene) {
    const std::vector<Transfer>& transfer = setting.options.transfer;
    HDR_ASSERT(transfer.size() == scene_.meshes.size());
    const View<const float> map = setting.light.latlong();
    for (std::size_t m = 0; m < transfer.size(); ++m) {
      HDR_ASSERT(transfer[m].vectors.rows() == static_cast<Eigen::Index>(scene_.meshes[m].positions.size()));
      vertices_.push_back(relit(transfer[m], project(map, LatLong{map.size()}, transfer[m].degree)));
    }
  }

  void begin(const Pass&) override {}

  void irradiance(const Surfaces& at, const Pass&, Light& out, std::int64_t&) const override {
    for (int place = 0; place < at.count(); ++place) {
      const std::optional<Hit>& hit = at.hits[static_cast<std::size_t>(place)];
      if (!at.diffuse[static_cast<std::size_t>(place)]) continue;
      Rgbf irradiance = Rgbf::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = scene_.meshes[hit->mesh].indices[3 * std::size_t{hit->triangle} + k];
        irradiance += hit->weights[k] * vertices_[hit->mesh].row(vertex).transpose().array();
      }
      out.add(place, irradiance.max(0.0f));  // few coefficients of a sun ring below zero
    }
  }

  bool exact() const override { return true; }

 private:
  const Scene& scene_;
  std::vector<Eigen::Matrix<float, Eigen::Dynamic, 3>> vertices_;  ///< irradiance, one matrix a mesh
};

}  // namespace

std::unique_ptr<Integrator> make_prt(const Setting& setting) {
  return std::make_unique<TransferIrradiance>(setting);
}

}  // namespace hdr
