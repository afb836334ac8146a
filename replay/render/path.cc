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

}  // namespace windhover::replay
