#pragma once
#include <algorithm>
#include <cstring>

#include "libhdr/core/rows.h"

namespace hdr::internal {

/// What every decoder shares: rows come from produce() once each, in order, and those of the asked window are kept.
template <class T>
class RowWindow : public PhotoRows {
 public:
  Size size() const final { return size_; }

  CodesView rows(int first, int last) final {
    HDR_ASSERT(0 <= first && first <= last && last <= size_.height);
    HDR_ASSERT(first >= begin_ && last >= last_);
    last_ = last;
    if (first > end_) {
      skip(end_, first);
      end_ = first;
    }
    begin_row_ += std::min(first, end_) - begin_;
    begin_ = first;
    if (last > end_) {
      const int end = std::min(size_.height, (last + rows_at_once_ - 1) / rows_at_once_ * rows_at_once_);
      make_room(end - begin_);
      produce(end_, end, buffer_.view().rows(begin_row_ + end_ - begin_, begin_row_ + end - begin_));
      end_ = end;
    }
    return View<const T>(buffer_.view()).rows(begin_row_, begin_row_ + last - first);
  }

 protected:
  /// `rows_at_once`: produce() is asked for multiples of this (or up to the last row).
  RowWindow(Size size, int rows_at_once) : size_(size), rows_at_once_(rows_at_once) {}

  /// Rows first .. last - 1 into `out`.
  virtual void produce(int first, int last, View<T> out) = 0;
  /// They are not asked for, and never will be.
  virtual void skip(int first, int last) = 0;

 private:
  /// Room for `count` rows from begin_ on. The buffer holds twice what is asked: rows that stay are moved to its start
  /// only when its end is reached.
  void make_room(int count) {
    if (begin_row_ + count <= buffer_.height()) return;
    Image<T> larger = 2 * count > buffer_.height() ? Image<T>(size_.width, 2 * count, 3) : Image<T>();
    Image<T>& to = larger.empty() ? buffer_ : larger;
    for (int k = 0; k < end_ - begin_; ++k) {
      std::memmove(to.row(k), buffer_.row(begin_row_ + k), sizeof(T) * to.row_samples());
    }
    if (!larger.empty()) buffer_ = std::move(larger);
    begin_row_ = 0;
  }

  Size size_;
  int rows_at_once_;
  Image<T> buffer_;
  int begin_ = 0, end_ = 0;  ///< rows in the buffer, of which begin_ is its row begin_row_
  int begin_row_ = 0;
  int last_ = 0;  ///< as asked
};

}  // namespace hdr::internal
