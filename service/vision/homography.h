// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gpu-kernels/matrix3.h"

namespace windhover {

using Matrix8d = Eigen::Matrix<double, 8, 8>;

// A homography is determined by this many points, and checked by none of them.
inline constexpr int kMinimalMatches = 4;

// One point seen in both pictures, px.
struct PointMatch {
  Eigen::Vector2d x_in_reference = Eigen::Vector2d::Zero();
  Eigen::Vector2d x_in_frame = Eigen::Vector2d::Zero();
  // Covariance of the displacement between the two, px^2, positive definite.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
};

Eigen::Vector2d Project(const Eigen::Matrix3d& b_from_a, const Eigen::Vector2d& x_in_a);
Matrix3 ToMatrix3(const Eigen::Matrix3d& matrix);

// Inverse, normalised to h33 = 1.
Eigen::Matrix3d InverseHomography(const Eigen::Matrix3d& b_from_a);

// The four corners of a picture of this size, px: top left, top right, bottom right, bottom left.
std::array<Eigen::Vector2d, 4> PictureCorners(int width, int height);

// Whether the homography keeps the picture's orientation and all of it in front of the camera.
bool IsOrientationPreserving(const Eigen::Matrix3d& b_from_a, int width, int height);

// Share, 0 to 1, of picture a (of the first size) that lies on picture b (of the second size), to
// within a few percent: counted on a grid of points.
double OverlapShare(const Eigen::Matrix3d& b_from_a, int a_width, int a_height, int b_width,
                    int b_height);

// Normalised direct linear transform over the matches with use != 0 (an empty `use` takes all).
// Hartley & Zisserman, Multiple View Geometry, algorithm 4.2. Nothing when fewer than four are used
// or they do not determine a homography (three of four on a line, say).
std::optional<Eigen::Matrix3d> HomographyByDlt(std::span<const PointMatch> matches,
                                               std::span<const std::uint8_t> use);

}  // namespace windhover
