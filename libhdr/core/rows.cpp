#include "libhdr/core/rows.h"

namespace hdr {
namespace {

class RowsInMemory final : public PhotoRows {
 public:
  explicit RowsInMemory(const Photo& photo) : photo_(photo) {}

  Size size() const override { return photo_.size(); }
  CodesView rows(int first, int last) override {
    return std::visit([&](const auto& image) -> CodesView { return image.view().rows(first, last); }, photo_.codes);
  }

 private:
  const Photo& photo_;
};

}  // namespace

std::unique_ptr<PhotoRows> rows_of(const Photo& photo) {
  return std::make_unique<RowsInMemory>(photo);
}

}  // namespace hdr
