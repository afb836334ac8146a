// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

namespace windhover::replay {

// What is left between two pictures after one was warped onto the other: how well registration has
// done where there is no truth. In grey levels of the pictures smoothed by 1 px; medians, so that
// what moves and what stands high has no say as long as most of the ground lies still.
struct GroundResidual {
  double warped = 0;    // median absolute difference
  double unwarped = 0;  // the same between the pictures as they are
  // What white noise in the pictures alone would leave.
  double noise = 0;
  // Median steepness of the ground at the same pixels, grey levels a px.
  double gradient = 0;
  int pixels = 0;  // that were looked at

  // About how far off the warp is, px: the error of which a residual beyond noise would be the
  // median, its directions to the gradients' being all alike.
  double misplacement_px() const;
};

// Between `b` and `a` warped onto it by `a_from_b` (any scale); both are CV_8UC1 of one size.
// Looked at is that tenth of their common area, 5 px within both borders, in which b's gradient is
// the largest. A change of brightness, the median difference in the flatter half of that area, is
// taken out before; noise is measured in the same half of b (Immerkaer, "Fast Noise Variance
// Estimation", CVIU 1996). Nothing where fewer than kLeastResidualPixels are in common and for a
// matrix without inverse.
inline constexpr int kLeastResidualPixels = 1000;
std::optional<GroundResidual> MeasureGroundResidual(const cv::Mat& a, const cv::Mat& b,
                                                    const Eigen::Matrix3d& a_from_b);

}  // namespace windhover::replay
