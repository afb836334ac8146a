// SPDX-License-Identifier: Apache-2.0
#include "replay/baselines/ecc_registration.h"

#include <opencv2/video/tracking.hpp>

namespace windhover::replay {
namespace {

const cv::TermCriteria kEnd(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-4);
constexpr int kSmoothingPx = 5;  // side of the Gaussian filter, OpenCV's default

}  // namespace

std::optional<Eigen::Matrix3d> EccRegistration::Register(const cv::Mat& gray) {
  std::optional<Eigen::Matrix3d> start;
  if (start_ == Start::kPhaseCorrelation) start = phase_.Register(gray);
  const cv::Mat previous = previous_;
  previous_ = gray.clone();
  if (previous.empty()) return std::nullopt;
  cv::Mat_<float> warp = cv::Mat_<float>::eye(3, 3);
  if (start) {
    warp(0, 2) = static_cast<float>((*start)(0, 2));
    warp(1, 2) = static_cast<float>((*start)(1, 2));
  }
  try {
    cv::findTransformECC(gray, previous, warp, cv::MOTION_HOMOGRAPHY, kEnd, cv::noArray(),
                         kSmoothingPx);
  } catch (const cv::Exception& error) {
    // OpenCV's way to say that the pictures do not correlate.
    if (error.code == cv::Error::StsNoConv) return std::nullopt;
    throw;
  }
  if (!cv::checkRange(warp) || warp(2, 2) == 0) return std::nullopt;
  Eigen::Matrix3d previous_from_frame;
  for (int i = 0; i < 9; ++i) previous_from_frame(i / 3, i % 3) = warp(i / 3, i % 3);
  return previous_from_frame / previous_from_frame(2, 2);
}

void EccRegistration::Reset() {
  phase_.Reset();
  previous_.release();
}

}  // namespace windhover::replay
