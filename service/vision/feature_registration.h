// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "service/vision/homography.h"
#include "service/vision/picture_features.h"
#include "service/vision/types.h"

namespace windhover {

// Why two pictures could not be registered.
enum class FeatureRegistrationFailure : std::uint8_t {
  kNoTexture,              // too few features in one of the pictures
  kTooFewMatches,          // too few features that look alike
  kTooFewInliers,          // no more matches agree on one homography than do by chance
  kImplausibleHomography,  // they agree on one that no camera over the ground has seen
};
// "no texture", "too few matches", "too few inliers", "implausible homography".
const char* NameOf(FeatureRegistrationFailure failure);

// How two pictures lie over each other.
struct FeatureRegistrationResult {
  // Points of the reference to the frame, h33 = 1. The identity where there is a failure.
  Eigen::Matrix3d frame_from_reference = Eigen::Matrix3d::Identity();
  // Covariance in px^2 of where it puts the reference's four corners in the frame, in the order of
  // PictureCorners, each x then y. Zero where there is a failure.
  Matrix8d corner_covariance = Matrix8d::Zero();
  int matches = 0;  // by descriptor alone
  int inliers = 0;  // in the end, with those that were found with the homography's help
  // Root mean square distance of the inliers from the homography, in the frame, px.
  double residual_px = 0.0;
  // Share of the reference, 0 to 1, that lies on the frame.
  double overlap = 0.0;
  // kDegraded where a large share of the matches contradicts, or where a corner is known less well
  // than to the inlier distance; kLost where there is a failure.
  RegistrationQuality quality = RegistrationQuality::kLost;
  std::optional<FeatureRegistrationFailure> failure;
};

// Registers two pictures of one plane by local features: the gold standard of the thesis (algorithm
// 1). Detection, description, ratio test; RANSAC or least median of squares; normalised DLT; the
// maximum likelihood homography with the true points (eq. 2.10, distances in both pictures); then
// the homography finds further matches, and they a better homography, until the inliers stay the
// same. Needs no prediction: any shift, any rotation, scales of about 0.5 to 2.
//
// Deterministic: the same pictures give the same result to the bit. Threads may share one.
class FeatureRegistration {
 public:
  // Throws OptionError.
  explicit FeatureRegistration(const FeatureRegistrationOptions& options);

  // The features of a picture, to be kept for as many registrations as it takes part in. As
  // DetectFeatures.
  PictureFeatures Detect(const GrayImage& picture, const GrayImage* mask = nullptr) const;

  // The pictures may be of different sizes. Whatever they show, all numbers of a result are finite.
  // Throws std::invalid_argument for features of two detectors.
  FeatureRegistrationResult Register(const PictureFeatures& reference,
                                     const PictureFeatures& frame) const;

 private:
  FeatureRegistrationOptions options_;
};

}  // namespace windhover
