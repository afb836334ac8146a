// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace windhover::replay {

// Calls visit(x, y) for each pixel whose centre lies in the convex outline `points` (a range of
// Eigen::Vector2d, px), in columns [first_column, end_column) and rows [first_row, end_row).
template <typename Points, typename Visit>
void ForEachPixelInside(const Points& points, int first_column, int end_column, int first_row,
                        int end_row, Visit&& visit) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double top = kInfinity;
  double bottom = -kInfinity;
  for (const auto& point : points) {
    top = std::min(top, point.y());
    bottom = std::max(bottom, point.y());
  }
  if (!(top < end_row && bottom >= first_row)) return;
  const int y0 = std::max(first_row, static_cast<int>(std::ceil(top)));
  const int y1 = std::min(end_row - 1, static_cast<int>(std::floor(bottom)));
  for (int y = y0; y <= y1; ++y) {
    double left = kInfinity;
    double right = -kInfinity;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto& a = points[i];
      const auto& b = points[(i + 1) % points.size()];
      if ((a.y() <= y) == (b.y() <= y)) continue;
      const double x = a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      left = std::min(left, x);
      right = std::max(right, x);
    }
    if (!(left < end_column && right >= first_column)) continue;
    const int x0 = std::max(first_column, static_cast<int>(std::ceil(left)));
    const int x1 = std::min(end_column, static_cast<int>(std::ceil(right)));
    for (int x = x0; x < x1; ++x) visit(x, y);
  }
}

}  // namespace windhover::replay
