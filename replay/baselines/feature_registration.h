// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/features2d.hpp>
#include <vector>

#include "replay/baselines/registration_peer.h"

namespace windhover::replay {

// Local features: detect, match the nearest descriptors where the second nearest is clearly
// further away (Lowe's ratio test), RANSAC on a homography.
class FeatureRegistration : public RegistrationPeer {
 public:
  // `norm` is how descriptors are compared, as in cv::NormTypes.
  FeatureRegistration(cv::Ptr<cv::Feature2D> features, int norm);

  std::optional<Eigen::Matrix3d> Register(const cv::Mat& gray) override;
  void Reset() override;

 private:
  struct Features {
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
  };

  cv::Ptr<cv::Feature2D> detector_;
  cv::BFMatcher matcher_;
  Features previous_;
  Features current_;
  std::vector<std::vector<cv::DMatch>> matches_;
  std::vector<cv::Point2f> from_;
  std::vector<cv::Point2f> to_;
};

// Up to 1000 of each picture's strongest points.
std::unique_ptr<FeatureRegistration> MakeOrbRegistration();
std::unique_ptr<FeatureRegistration> MakeSiftRegistration();
// All points above OpenCV's default threshold.
std::unique_ptr<FeatureRegistration> MakeAkazeRegistration();

}  // namespace windhover::replay
