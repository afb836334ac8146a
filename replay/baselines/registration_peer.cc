// SPDX-License-Identifier: Apache-2.0
#include "replay/baselines/registration_peer.h"

#include <opencv2/calib3d.hpp>

namespace windhover::replay {

std::optional<Eigen::Matrix3d> RansacHomography(const std::vector<cv::Point2f>& in_a,
                                                const std::vector<cv::Point2f>& in_b,
                                                double ransac_px) {
  if (in_a.size() < 4) return std::nullopt;
  const cv::Mat matrix = cv::findHomography(in_a, in_b, cv::RANSAC, ransac_px);
  if (matrix.empty() || matrix.at<double>(2, 2) == 0) return std::nullopt;
  Eigen::Matrix3d b_from_a;
  for (int i = 0; i < 9; ++i) b_from_a(i / 3, i % 3) = matrix.at<double>(i / 3, i % 3);
  return b_from_a / b_from_a(2, 2);
}

}  // namespace windhover::replay
