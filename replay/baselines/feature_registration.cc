// SPDX-License-Identifier: Apache-2.0
#include "replay/baselines/feature_registration.h"

#include <utility>

namespace windhover::replay {
namespace {

constexpr int kPoints = 1000;
// D. Lowe, "Distinctive image features from scale-invariant keypoints", 2004, section 7.1.
constexpr float kRatio = 0.8F;
// Local features are placed less exactly than tracked points: OpenCV's own default.
constexpr double kRansacPx = 3.0;

}  // namespace

FeatureRegistration::FeatureRegistration(cv::Ptr<cv::Feature2D> features, int norm)
    : detector_(std::move(features)), matcher_(norm) {}

std::optional<Eigen::Matrix3d> FeatureRegistration::Register(const cv::Mat& gray) {
  std::swap(previous_, current_);
  detector_->detectAndCompute(gray, cv::noArray(), current_.points, current_.descriptors);
  if (previous_.points.empty() || current_.points.empty()) return std::nullopt;
  matches_.clear();  // knnMatch appends
  matcher_.knnMatch(current_.descriptors, previous_.descriptors, matches_, 2);
  from_.clear();
  to_.clear();
  for (const std::vector<cv::DMatch>& nearest : matches_) {
    if (nearest.size() < 2 || nearest[0].distance > kRatio * nearest[1].distance) continue;
    from_.push_back(current_.points[nearest[0].queryIdx].pt);
    to_.push_back(previous_.points[nearest[0].trainIdx].pt);
  }
  return RansacHomography(from_, to_, kRansacPx);
}

void FeatureRegistration::Reset() {
  previous_ = {};
  current_ = {};
}

std::unique_ptr<FeatureRegistration> MakeOrbRegistration() {
  return std::make_unique<FeatureRegistration>(cv::ORB::create(kPoints), cv::NORM_HAMMING);
}

std::unique_ptr<FeatureRegistration> MakeSiftRegistration() {
  return std::make_unique<FeatureRegistration>(cv::SIFT::create(kPoints), cv::NORM_L2);
}

std::unique_ptr<FeatureRegistration> MakeAkazeRegistration() {
  return std::make_unique<FeatureRegistration>(cv::AKAZE::create(), cv::NORM_HAMMING);
}

}  // namespace windhover::replay
