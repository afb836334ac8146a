// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "service/options/feature_options.h"
#include "service/vision/homography.h"
#include "service/vision/homography_refiner.h"

namespace windhover {

struct HomographyEstimatorOptions {
  RobustEstimator robust = RobustEstimator::kRansac;
  // Distance in the reference picture up to which a match is an inlier, px. Least median of squares
  // takes it from the matches and this as its upper limit.
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

// Homography from matches with mismatches among them: RANSAC or least median of squares (thesis
// 2.3.1), normalised DLT, then the maximum likelihood estimate over the homography and the true
// points, weighted by the matches' covariances and robust against things that stand out of the
// ground (thesis eq. 2.21 to 2.28, HomographyRefiner). Deterministic. Keeps its working memory; one
// thread at a time.
class HomographyEstimator {
 public:
  HomographyEstimator(int frame_width, int frame_height, const HomographyEstimatorOptions& options);

  // Nothing when fewer than four matches agree or the result is degenerate: mirrored, or with part
  // of the frame behind the camera. All numbers of a result are finite.
  std::optional<HomographyEstimate> Estimate(std::span<const PointMatch> matches);

  // The same from a homography that is known roughly, in place of sampling; inliers are told by the
  // last Estimate's distance.
  std::optional<HomographyEstimate> EstimateFrom(const Eigen::Matrix3d& initial,
                                                 std::span<const PointMatch> matches);

  // For each match of the last call: 1 when it is an inlier of its result, or of the one that was
  // refused as degenerate.
  std::span<const std::uint8_t> inliers() const { return inliers_; }

 private:
  bool Ransac(std::span<const PointMatch> matches, Eigen::Matrix3d* best);
  bool LeastMedian(std::span<const PointMatch> matches, Eigen::Matrix3d* best);
  int SelectInliers(std::span<const PointMatch> matches, const Eigen::Matrix3d& model,
                    double threshold_px);

  int width_;
  int height_;
  HomographyEstimatorOptions options_;
  HomographyRefiner refiner_;
  double threshold_px_;
  std::vector<std::uint8_t> inliers_;
  std::vector<double> squared_px_;
};

}  // namespace windhover
