#include "tests/bench/hand_shake.h"

#include <algorithm>
#include <numbers>

#include "libhdr/core/random.h"

namespace hdr::bench {

std::vector<Mat3> hand_shake(Size size, int shots, double shift_px, double turn_degrees, std::uint64_t seed) {
  Random random(seed, 0xa119);
  const Vec2 middle(0.5 * (size.width - 1), 0.5 * (size.height - 1));
  std::vector<Mat3> motions;
  for (int k = 0; k < shots; ++k) {
    const double angle = turn_degrees * std::numbers::pi / 180 * (2 * random.uniform() - 1);
    const double x = shift_px * (2 * random.uniform() - 1), y = shift_px * (2 * random.uniform() - 1);
    const Eigen::Affine2d motion =
        Eigen::Translation2d(middle + Vec2(x, y)) * Eigen::Rotation2Dd(angle) * Eigen::Translation2d(-middle);
    motions.push_back(k == (shots - 1) / 2 ? Mat3(Mat3::Identity()) : Mat3(motion.matrix()));
  }
  return motions;
}

std::vector<double> motion_distances(const Mat3& truth, const Mat3& found, Size size) {
  std::vector<double> all;
  for (int k = 0; k < 63; ++k) {
    const Vec3 p((size.width - 1) * (k % 9) / 8.0, (size.height - 1) * (k / 9) / 6.0, 1);
    all.push_back(((truth * p).hnormalized() - (found * p).hnormalized()).norm());
  }
  std::sort(all.begin(), all.end());
  return all;
}

double rms_distance_where_usable(const Mat3& truth, const Mat3& found, const Photo& photo) {
  constexpr int kStep = 5;
  const auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
  double squares = 0, count = 0;
  for (int y = 0; y < codes.height(); y += kStep) {
    for (int x = 0; x < codes.width(); x += kStep) {
      const std::uint8_t* code = codes.pixel(x, y);
      if (std::min({code[0], code[1], code[2]}) < 5 || std::max({code[0], code[1], code[2]}) > 250) continue;
      const Vec3 p(x, y, 1);
      squares += ((truth * p).hnormalized() - (found * p).hnormalized()).squaredNorm();
      ++count;
    }
  }
  return count > 0 ? std::sqrt(squares / count) : 0;
}

double usable_share(const Photo& photo) {
  const auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
  std::int64_t usable = 0;
  for (int y = 0; y < codes.height(); ++y) {
    for (const std::uint8_t* p = codes.row(y); p != codes.row(y) + codes.row_samples(); p += 3) {
      usable += std::min({p[0], p[1], p[2]}) >= 5 && std::max({p[0], p[1], p[2]}) <= 250;
    }
  }
  return static_cast<double>(usable) / (static_cast<double>(codes.width()) * codes.height());
}

}  // namespace hdr::bench
