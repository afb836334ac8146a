// SPDX-License-Identifier: Apache-2.0
#include "replay/render/path.h"

#include <algorithm>
#include <utility>

namespace windhover::replay {

Path::Path(std::vector<Eigen::Vector2d> points) : points_(std::move(points)) {
  at_.push_back(0.0);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    at_.push_back(at_.back() + (points_[i] - points_[i - 1]).norm());
  }
}

Path::Place Path::At(double along, double right) const {
  const auto next = std::upper_bound(at_.begin() + 1, at_.end() - 1, along);
  const auto i = static_cast<std::size_t>(next - at_.begin());
  const Eigen::Vector2d forward = (points_[i] - points_[i - 1]) / (at_[i] - at_[i - 1]);
  return {points_[i - 1] + (along - at_[i - 1]) * forward + right * Right(forward), forward};
}

Path Path::Reversed() const { return Path({points_.rbegin(), points_.rend()}); }

Path RoundedPath(const std::vector<Eigen::Vector2d>& corners, double cut) {
  constexpr int kPieces = 12;  // of each bend, which is a parabola
  std::vector<Eigen::Vector2d> points = {corners.front()};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Eigen::Vector2d back = corners[i - 1] - corners[i];
    const Eigen::Vector2d on = corners[i + 1] - corners[i];
    const double reach = std::min({cut, 0.49 * back.norm(), 0.49 * on.norm()});
    const Eigen::Vector2d from = corners[i] + reach * back.normalized();
    const Eigen::Vector2d to = corners[i] + reach * on.normalized();
    for (int piece = 0; piece <= kPieces; ++piece) {
      const double t = static_cast<double>(piece) / kPieces;
      points.push_back((1 - t) * (1 - t) * from + 2 * t * (1 - t) * corners[i] + t * t * to);
    }
  }
  points.push_back(corners.back());
  return Path(std::move(points));
}

}  // namespace windhover::replay
