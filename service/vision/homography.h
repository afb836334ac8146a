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

struct HomographyEstimatorOptions {
  // Distance in the reference picture up to which a match is an inlier, px.
  double ransac_threshold_px = 1.0;
  int max_ransac_iterations = 300;
};

struct HomographyEstimate {
  Eigen::Matrix3d reference_from_frame = Eigen::Matrix3d::Identity();
  // Covariance in px^2 of the frame's corners, in the order of PictureCorners, in the reference
  // picture. Scaled by the inliers' own scatter, so that only the ratios of the matches'
  // covariances matter (thesis 2.4.3); with fewer than 8 inliers never below what those covariances
  // say.
  Matrix8d corner_covariance = Matrix8d::Zero();
  int inliers = 0;
  // Root mean square distance of the inliers in the reference picture, px.
  double residual_px = 0.0;
};

// Homography from matches with mismatches among them: RANSAC, normalised DLT, then the maximum
// likelihood estimate over the homography and the true points, weighted by the matches' covariances
// (thesis eq. 2.21 to 2.28). Deterministic. Keeps its working memory; one thread at a time.
class HomographyEstimator {
 public:
  HomographyEstimator(int frame_width, int frame_height, const HomographyEstimatorOptions& options);

  // Nothing when fewer than four matches agree or the result is degenerate: mirrored, or with part
  // of the frame behind the camera. All numbers of a result are finite.
  std::optional<HomographyEstimate> Estimate(std::span<const PointMatch> matches);

  // For each match of the last call: 1 when it is an inlier of its result.
  std::span<const std::uint8_t> inliers() const { return inliers_; }

 private:
  bool Ransac(std::span<const PointMatch> matches, Eigen::Matrix3d* best);
  int SelectInliers(std::span<const PointMatch> matches, const Eigen::Matrix3d& model,
                    double threshold_px);

  int width_;
  int height_;
  HomographyEstimatorOptions options_;
  std::vector<std::uint8_t> inliers_;
};

}  // namespace windhover
