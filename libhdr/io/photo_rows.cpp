#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/orientation.h"
#include "libhdr/io/internal/row_window.h"
#include "libhdr/io/internal/scratch_file.h"
#include "libhdr/io/internal/stored_rows.h"
#include "libhdr/io/read.h"

namespace hdr {
namespace {

using internal::StoredRows;

/// An upright picture, decoded as its rows are asked for.
template <class T>
class DecodedRows final : public internal::RowWindow<T> {
 public:
  DecodedRows(std::shared_ptr<OIIO::ImageInput> input, const Path& path, Size size)
      : internal::RowWindow<T>(size, 1), input_(std::move(input)), stored_(*input_, path) {
    if (size.width < input_->spec().width) whole_row_ = Image<T>(input_->spec().width, 1, 3);
  }

 private:
  void produce(int first, int last, View<T> out) override {
    for (int y = first; y < last; ++y) {
      T* row = out.row(y - first);
      stored_.next(whole_row_.empty() ? row : whole_row_.row(0));
      if (!whole_row_.empty()) std::copy_n(whole_row_.row(0), 3 * out.width(), row);
    }
  }
  void skip(int first, int last) override {
    if (whole_row_.empty()) whole_row_ = Image<T>(input_->spec().width, 1, 3);
    for (int y = first; y < last; ++y) stored_.next(whole_row_.row(0));
  }

  std::shared_ptr<OIIO::ImageInput> input_;
  StoredRows<T> stored_;
  Image<T> whole_row_;  ///< for cropped pictures, and rows that are passed over
};

/// A picture that is turned, or that cannot be decoded in one pass: decoded whole, when its first rows are asked for,
/// into a file without a name, from which the rows are read back upright.
template <class T>
class SpilledRows final : public internal::RowWindow<T> {
 public:
  SpilledRows(Path path, const OIIO::ImageSpec& spec, Size size)
      : internal::RowWindow<T>(size, rows_at_once(spec)),
        path_(std::move(path)),
        stored_{spec.width, spec.height},
        orientation_(internal::orientation_of(spec)) {}

 private:
  /// Rows of a picture on its side are columns of the file, and are read back in strips.
  static int rows_at_once(const OIIO::ImageSpec& spec) {
    return internal::Orientation(internal::orientation_of(spec)).on_its_side ? 64 : 1;
  }

  void spill() {
    // One at a time: some of these decoders need memory for the whole picture. Nothing in here waits for other threads.
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    const auto input = internal::open_picture(path_);
    if (input->spec().width != stored_.width || input->spec().height != stored_.height) {
      throw Error(path_.string() + ": has changed while it was in use; start again");
    }
    StoredRows<T> rows(*input, path_);
    Image<T> row(stored_.width, 1, 3);
    file_.emplace(path_.string());
    for (int y = 0; y < stored_.height; ++y) {
      rows.next(row.row(0));
      file_->append(row.row(0), row.row_samples() * sizeof(T));
    }
  }

  void read(int x, int y, T* pixels, int count) const {
    const std::int64_t before = 3 * (static_cast<std::int64_t>(y) * stored_.width + x);
    file_->read_at(before * static_cast<std::int64_t>(sizeof(T)), pixels,
                   3 * sizeof(T) * static_cast<std::size_t>(count));
  }

  void produce(int first, int last, View<T> out) override {
    if (!file_) spill();
    if (orientation_.on_its_side) {
      read_columns(first, last, out);
    } else {
      read_rows(first, last, out);
    }
  }

  void read_rows(int first, int last, View<T> out) const {
    const int left = orientation_.from_right ? stored_.width - out.width() : 0;
    for (int y = first; y < last; ++y) {
      const int row = y - first;
      read(left, orientation_.from_bottom ? stored_.height - 1 - y : y, out.row(row), out.width());
      if (!orientation_.from_right) continue;
      for (int x = 0, mirrored = out.width() - 1; x < mirrored; ++x, --mirrored) {
        std::swap_ranges(out.pixel(x, row), out.pixel(x, row) + 3, out.pixel(mirrored, row));
      }
    }
  }

  void read_columns(int first, int last, View<T> out) const {
    const int count = last - first, left = orientation_.from_right ? stored_.width - last : first;
    Image<T> strip(count, 1, 3);
    for (int x = 0; x < out.width(); ++x) {
      read(left, orientation_.from_bottom ? stored_.height - 1 - x : x, strip.row(0), count);
      for (int y = 0; y < count; ++y) {
        std::copy_n(strip.pixel(orientation_.from_right ? count - 1 - y : y, 0), 3, out.pixel(x, y));
      }
    }
  }

  void skip(int, int) override {}

  Path path_;
  Size stored_;
  internal::Orientation orientation_;
  std::optional<internal::ScratchFile> file_;
};

template <class T>
std::unique_ptr<PhotoRows> rows_in(const internal::OpenedPicture& opened, const Path& path, Size size) {
  const bool streams = opened.in_one_pass && internal::orientation_of(opened.input->spec()) == 1;
  if (streams) return std::make_unique<DecodedRows<T>>(opened.input, path, size);
  return std::make_unique<SpilledRows<T>>(path, opened.input->spec(), size);
}

}  // namespace

std::unique_ptr<PhotoRows> open_photo_rows(const Path& path, std::optional<Size> top_left) {
  const internal::OpenedPicture opened = internal::open_picture_for_rows(path);
  const int bits = internal::bits_of(opened.input->spec(), path);
  const Size whole = internal::upright_size(opened.input->spec());
  const Size size = top_left.value_or(whole);
  if (size.width > whole.width || size.height > whole.height) {
    throw Error(fmt::format("{}: has {}x{} pixels, fewer than the {}x{} that are wanted of it", path.string(),
                            whole.width, whole.height, size.width, size.height));
  }
  if (bits == 8) return rows_in<std::uint8_t>(opened, path, size);
  return rows_in<std::uint16_t>(opened, path, size);
}

}  // namespace hdr
