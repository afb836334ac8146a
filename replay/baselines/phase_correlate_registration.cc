// SPDX-License-Identifier: Apache-2.0
#include "replay/baselines/phase_correlate_registration.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace windhover::replay {

std::optional<Eigen::Matrix3d> PhaseCorrelateRegistration::Register(const cv::Mat& gray) {
  cv::swap(previous_, current_);
  gray.convertTo(current_, CV_32F);
  if (window_.empty()) cv::createHanningWindow(window_, gray.size(), CV_32F);
  if (previous_.empty()) return std::nullopt;
  const cv::Point2d shift = cv::phaseCorrelate(current_, previous_, window_);
  if (!std::isfinite(shift.x) || !std::isfinite(shift.y)) return std::nullopt;
  Eigen::Matrix3d previous_from_frame = Eigen::Matrix3d::Identity();
  previous_from_frame(0, 2) = shift.x;
  previous_from_frame(1, 2) = shift.y;
  return previous_from_frame;
}

void PhaseCorrelateRegistration::Reset() {
  previous_.release();
  current_.release();
}

}  // namespace windhover::replay
