// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace windhover::replay {

// The rendered world is a map in metres: x right, y down the page, height above it. A unit vector
// `forward` has its right hand at Right(forward).
inline Eigen::Vector2d Right(const Eigen::Vector2d& forward) { return {-forward.y(), forward.x()}; }

// A line through the map, measured by its length.
class Path {
 public:
  struct Place {
    Eigen::Vector2d position;
    Eigen::Vector2d forward;  // unit length
  };

  // At least two points, none repeated.
  explicit Path(std::vector<Eigen::Vector2d> points);

  double length() const { return at_.back(); }
  const std::vector<Eigen::Vector2d>& points() const { return points_; }
  // Length from the start to points()[i].
  double at(std::size_t i) const { return at_[i]; }
  // `along` from the start, `right` metres to the right of the line; the ends go on straight.
  Place At(double along, double right = 0.0) const;
  Path Reversed() const;

 private:
  std::vector<Eigen::Vector2d> points_;
  std::vector<double> at_;
};

// The line through `corners` with each corner rounded off from `cut` metres before it to `cut`
// after it, or from half of the shorter side where that is less.
Path RoundedPath(const std::vector<Eigen::Vector2d>& corners, double cut);

}  // namespace windhover::replay
