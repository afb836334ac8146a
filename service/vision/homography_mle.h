// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>

#include "service/vision/homography.h"

namespace windhover {

struct HomographyFit {
  Eigen::Matrix3d reference_from_frame = Eigen::Matrix3d::Identity();  // h33 = 1
  Matrix8d corner_covariance = Matrix8d::Zero();                       // see HomographyEstimate
};

// Maximum likelihood homography over the matches with use != 0, from a starting value: minimises
// eq. 2.21 over the homography and the true points,
//   sum_i (x_i - xt_i)^T S_i^-1 (x_i - xt_i) + (x'_i - P xt_i)^T S'_i^-1 (x'_i - P xt_i),
// with x in the frame, x' in the reference picture, and half of each match's covariance on either
// side. The covariances enter through their Cholesky factors (eq. 2.25 to 2.28) inside the normal
// equations; the true points are eliminated from them (Schur complement), so that each step solves
// an 8x8 system. Levenberg-Marquardt; errata of the thesis: 2.23's first row is measured minus
// true. Nothing when the system is singular or the result is not finite.
std::optional<HomographyFit> RefineHomography(std::span<const PointMatch> matches,
                                              std::span<const std::uint8_t> use,
                                              const Eigen::Matrix3d& initial, int frame_width,
                                              int frame_height);

}  // namespace windhover
