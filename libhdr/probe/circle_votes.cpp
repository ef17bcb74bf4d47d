#include "libhdr/probe/internal/circle_votes.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr::internal {
namespace {

struct Edge {
  float x, y;    ///< continuous pixels
  float gx, gy;  ///< unit gradient
  float weight;
};

struct Vote {
  Disc circle;
  double score;
};

/// Ridges of the gradient's magnitude. An edge's weight is its strength against its surroundings, so that a faint
/// outline before a soft backdrop counts as much as the contrasts of a window.
std::vector<Edge> edges_of(View<const float> picture) {
  const cv::Mat log_picture(picture.height(), picture.width(), CV_32F, const_cast<float*>(picture.data()),
                            static_cast<std::size_t>(picture.stride()) * sizeof(float));
  cv::Mat smooth, gx, gy, strength, surroundings;
  cv::GaussianBlur(log_picture, smooth, {}, 1.0);
  cv::Scharr(smooth, gx, CV_32F, 1, 0, 1.0 / 32);
  cv::Scharr(smooth, gy, CV_32F, 0, 1, 1.0 / 32);
  cv::magnitude(gx, gy, strength);
  cv::GaussianBlur(strength, surroundings, {}, 8.0);
  const auto floor = static_cast<float>(0.1 * cv::mean(strength)[0] + 1e-6);

  std::vector<Edge> edges;
  for (int y = 1; y + 1 < strength.rows; ++y) {
    for (int x = 1; x + 1 < strength.cols; ++x) {
      const float s = strength.at<float>(y, x);
      if (s < floor) continue;
      const float ux = gx.at<float>(y, x) / s, uy = gy.at<float>(y, x) / s;
      const int dx = static_cast<int>(std::lround(ux)), dy = static_cast<int>(std::lround(uy));
      if (s < strength.at<float>(y + dy, x + dx) || s < strength.at<float>(y - dy, x - dx)) continue;
      const float weight = s / (s + surroundings.at<float>(y, x) + floor);
      edges.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, ux, uy, weight});
    }
  }
  return edges;
}

/// Votes for centres of circles of one radius, in cells of two pixels, and their local maxima.
std::vector<Vote> votes_at(const std::vector<Edge>& edges, Size size, double radius) {
  constexpr float kCell = 2;
  cv::Mat votes = cv::Mat::zeros(size.height / 2 + 1, size.width / 2 + 1, CV_32F);
  for (const Edge& edge : edges) {
    for (const float side : {-1.0f, 1.0f}) {
      const float cx = edge.x + side * static_cast<float>(radius) * edge.gx;
      const float cy = edge.y + side * static_cast<float>(radius) * edge.gy;
      if (cx < 0 || cy < 0 || cx >= static_cast<float>(size.width) || cy >= static_cast<float>(size.height)) continue;
      votes.at<float>(static_cast<int>(cy / kCell), static_cast<int>(cx / kCell)) += edge.weight;
    }
  }
  // An edge's direction is known to a few degrees: the vote spreads with the radius.
  constexpr double kDirectionError = 0.03;
  cv::GaussianBlur(votes, votes, {}, 0.6 + kDirectionError * radius / kCell);
  cv::Mat highest;
  cv::dilate(votes, highest, cv::Mat::ones(5, 5, CV_8U));

  std::vector<Vote> peaks;
  for (int y = 0; y < votes.rows; ++y) {
    for (int x = 0; x < votes.cols; ++x) {
      const float v = votes.at<float>(y, x);
      if (v <= 0 || v < highest.at<float>(y, x)) continue;
      const Disc circle{(x + 0.5) * kCell, (y + 0.5) * kCell, radius};
      peaks.push_back({circle, v});
    }
  }
  const auto better = [](const Vote& a, const Vote& b) { return a.score > b.score; };
  constexpr std::size_t kMostARadius = 8;
  if (peaks.size() > kMostARadius) {
    std::partial_sort(peaks.begin(), peaks.begin() + kMostARadius, peaks.end(), better);
    peaks.resize(kMostARadius);
  }
  return peaks;
}

bool alike(const Disc& a, const Disc& b) {
  constexpr double kNear = 3;
  return std::abs(a.r - b.r) + std::hypot(a.cx - b.cx, a.cy - b.cy) < kNear;
}

}  // namespace

std::vector<Disc> vote_for_circles(View<const float> log_picture, double least_radius, double most_radius, int most) {
  const std::vector<Edge> edges = edges_of(log_picture);
  const int radii = std::max(0, static_cast<int>(most_radius - least_radius) + 1);
  std::vector<Vote> all = reduce_rows(
      radii, 1, std::vector<Vote>(),
      [&](int first, int) { return votes_at(edges, log_picture.size(), least_radius + first); },
      [](std::vector<Vote>& total, const std::vector<Vote>& part) {
        total.insert(total.end(), part.begin(), part.end());
      });
  std::stable_sort(all.begin(), all.end(), [](const Vote& a, const Vote& b) { return a.score > b.score; });
  std::vector<Disc> circles;
  for (const Vote& vote : all) {
    if (static_cast<int>(circles.size()) >= most) break;
    const bool known =
        std::any_of(circles.begin(), circles.end(), [&](const Disc& c) { return alike(c, vote.circle); });
    if (!known) circles.push_back(vote.circle);
  }
  return circles;
}

}  // namespace hdr::internal
