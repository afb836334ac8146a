// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace windhover::replay {

// The peer that registration is measured against: OpenCV's pyramidal Lucas-Kanade tracking of a
// 16 x 12 grid of points, then RANSAC on a homography. Each frame is registered to its predecessor.
class KltRegistration {
 public:
  // `gray` is CV_8UC1, always of one size. Returns previous_from_frame with h33 = 1; the identity
  // for the first frame and where too few points are found again.
  Eigen::Matrix3d Register(const cv::Mat& gray);

 private:
  std::vector<cv::Mat> previous_pyramid_;
  std::vector<cv::Mat> pyramid_;
  std::vector<cv::Point2f> grid_;
  std::vector<cv::Point2f> found_;
  std::vector<cv::Point2f> from_;
  std::vector<cv::Point2f> to_;
  std::vector<std::uint8_t> status_;
  std::vector<float> error_;
};

}  // namespace windhover::replay
