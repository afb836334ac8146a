// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "replay/baselines/registration_peer.h"

namespace windhover::replay {

// OpenCV's pyramidal Lucas-Kanade tracking of a 16 x 12 grid of points, then RANSAC on a
// homography.
class KltRegistration : public RegistrationPeer {
 public:
  std::optional<Eigen::Matrix3d> Register(const cv::Mat& gray) override;
  void Reset() override;

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
