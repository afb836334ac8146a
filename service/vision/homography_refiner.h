// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "service/vision/homography.h"

namespace windhover {

struct HomographyFit {
  Eigen::Matrix3d reference_from_frame = Eigen::Matrix3d::Identity();  // h33 = 1
  Matrix8d corner_covariance = Matrix8d::Zero();                       // see HomographyEstimate
};

// Maximum likelihood homography from a starting value: minimises
//   sum_i w_i ((x_i - xt_i)^T S_i^-1 (x_i - xt_i) + (x'_i - P xt_i)^T S'_i^-1 (x'_i - P xt_i))
// over the homography and the true points (eq. 2.21), with x in the frame, x' in the reference
// picture, and half of each match's covariance on either side. The covariances enter through their
// Cholesky factors (eq. 2.25 to 2.28) inside the normal equations; the true points are eliminated
// from them (Schur complement), so that each step solves an 8x8 system. Levenberg-Marquardt; errata
// of the thesis: 2.23's first row is measured minus true.
//
// The weights are Geman's and McClure's, w = (s^2 / (s^2 + r^2))^2 for a match that lies r px off.
// The scale s falls from `first_scale_px` to twice the matches' own scatter, so that among ground
// and things that stand out of it, which all agree within a pixel, the densest group, the ground,
// wins (Black and Rangarajan 1996: graduated non-convexity). An infinite scale weighs all alike.
class HomographyRefiner {
 public:
  HomographyRefiner(int frame_width, int frame_height);

  // Nothing when the system is singular or the result is not finite. Keeps its working memory.
  std::optional<HomographyFit> Refine(std::span<const PointMatch> matches,
                                      const Eigen::Matrix3d& initial, double first_scale_px);

 private:
  // Sets weights_ for a homography in px; returns the scale that they would best be taken at next.
  double Weigh(std::span<const PointMatch> matches, const Eigen::Matrix3d& h, double scale_px);

  int width_;
  int height_;
  std::vector<double> squared_distances_;
  std::vector<double> sorted_;
  std::vector<double> weights_;
};

}  // namespace windhover
