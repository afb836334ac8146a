// SPDX-License-Identifier: Apache-2.0
#include "service/vision/feature_registration.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "service/vision/feature_matching.h"
#include "service/vision/homography_estimator.h"

namespace windhover {
namespace {

// After M. Brown and D. Lowe, "Automatic panoramic image stitching using invariant features", 2007,
// section 3.2: so many inliers, and so large a share of the matches besides. They ask for 0.3 of
// the matches; fewer make a degraded result here.
constexpr int kLeastInliers = 8;
constexpr double kLeastShare = 0.1;
constexpr double kValidShare = 0.3;

// Four matches of which three in ten are right are drawn in so many samples with probability 0.999.
constexpr int kMostSamples = 1000;

// Magnification at a corner beyond which no detector would have found the points again.
constexpr double kMostMagnification = 10.0;

constexpr int kMostRounds = 10;

bool IsEnough(int inliers, int matches, double share) {
  return inliers >= kLeastInliers + share * matches;
}

// The estimator goes from its frame to its reference: these are our reference and our frame.
std::vector<PointMatch> PointsOf(std::span<const FeatureMatch> matches,
                                 const PictureFeatures& reference, const PictureFeatures& frame) {
  std::vector<PointMatch> points;
  points.reserve(matches.size());
  for (const FeatureMatch& match : matches) {
    const double a = reference.sigma_px[match.reference];
    const double b = frame.sigma_px[match.frame];
    points.push_back({.x_in_reference = frame.x_in_picture[match.frame],
                      .x_in_frame = reference.x_in_picture[match.reference],
                      .covariance = (a * a + b * b) * Eigen::Matrix2d::Identity()});
  }
  return points;
}

// The inliers by the pairs of features that they are.
std::vector<std::pair<int, int>> InlierPairs(std::span<const FeatureMatch> matches,
                                             std::span<const std::uint8_t> is_inlier) {
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (is_inlier[i] != 0) pairs.emplace_back(matches[i].reference, matches[i].frame);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// What nineteen of twenty inliers keep to.
double UsualDistance(std::span<const FeatureMatch> matches,
                     std::span<const std::uint8_t> is_inlier) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (is_inlier[i] != 0) distances.push_back(matches[i].distance);
  }
  const auto high = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() * 19 / 20);
  std::nth_element(distances.begin(), high, distances.end());
  return *high;
}

// Whether lengths at all corners of the picture change by no more than kMostMagnification.
bool IsPlausible(const Eigen::Matrix3d& b_from_a, int width, int height) {
  const auto corners = PictureCorners(width, height);
  const double determinant = b_from_a.determinant();
  return std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& x) {
    const double magnification =
        std::sqrt(determinant / std::pow(b_from_a.row(2).dot(x.homogeneous()), 3));
    return magnification <= kMostMagnification && magnification >= 1.0 / kMostMagnification;
  });
}

// Of the corner that is known least, along the direction in which it is.
double WorstCornerSigma(const Matrix8d& corner_covariance) {
  double variance = 0.0;
  for (int i = 0; i < 8; i += 2) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(corner_covariance.block<2, 2>(i, i),
                                                                Eigen::EigenvaluesOnly);
    variance = std::max(variance, solver.eigenvalues()[1]);
  }
  return std::sqrt(variance);
}

FeatureRegistrationResult Failed(FeatureRegistrationFailure failure, int matches, int inliers) {
  FeatureRegistrationResult result;
  result.failure = failure;
  result.matches = matches;
  result.inliers = inliers;
  return result;
}

}  // namespace

const char* NameOf(FeatureRegistrationFailure failure) {
  switch (failure) {
    case FeatureRegistrationFailure::kNoTexture:
      return "no texture";
    case FeatureRegistrationFailure::kTooFewMatches:
      return "too few matches";
    case FeatureRegistrationFailure::kTooFewInliers:
      return "too few inliers";
    case FeatureRegistrationFailure::kImplausibleHomography:
      return "implausible homography";
  }
  return "?";
}

FeatureRegistration::FeatureRegistration(const FeatureRegistrationOptions& options)
    : options_(options) {
  CheckOptions(options_);
}

PictureFeatures FeatureRegistration::Detect(const GrayImage& picture, const GrayImage* mask) const {
  return DetectFeatures(picture, mask, options_);
}

FeatureRegistrationResult FeatureRegistration::Register(const PictureFeatures& reference,
                                                        const PictureFeatures& frame) const {
  using Failure = FeatureRegistrationFailure;
  if (std::min(reference.size(), frame.size()) < kLeastInliers) {
    return Failed(Failure::kNoTexture, 0, 0);
  }
  std::vector<FeatureMatch> matches = MatchByRatio(reference, frame, options_.match_ratio);
  const int by_descriptor = static_cast<int>(matches.size());
  if (by_descriptor < kLeastInliers) return Failed(Failure::kTooFewMatches, by_descriptor, 0);

  HomographyEstimator estimator(reference.width, reference.height,
                                {.robust = options_.robust,
                                 .ransac_threshold_px = options_.inlier_distance_px,
                                 .max_ransac_iterations = kMostSamples});
  auto estimate = estimator.Estimate(PointsOf(matches, reference, frame));
  // Whether it is one is for the matches to say that were found without it.
  auto pairs = InlierPairs(matches, estimator.inliers());
  const int agreeing = static_cast<int>(pairs.size());
  if (!IsEnough(agreeing, by_descriptor, kLeastShare)) {
    return Failed(Failure::kTooFewInliers, by_descriptor, agreeing);
  }

  const double usual_distance = UsualDistance(matches, estimator.inliers());
  for (int round = 0; estimate && round < kMostRounds; ++round) {
    matches = MatchGuided(reference, frame, estimate->reference_from_frame,
                          options_.inlier_distance_px, options_.match_ratio, usual_distance);
    estimate =
        estimator.EstimateFrom(estimate->reference_from_frame, PointsOf(matches, reference, frame));
    auto next = InlierPairs(matches, estimator.inliers());
    const bool settled = next == pairs;
    pairs = std::move(next);
    if (settled) break;
  }
  const int inliers = static_cast<int>(pairs.size());
  if (inliers < kLeastInliers) return Failed(Failure::kTooFewInliers, by_descriptor, inliers);
  if (!estimate ||
      !IsPlausible(estimate->reference_from_frame, reference.width, reference.height)) {
    return Failed(Failure::kImplausibleHomography, by_descriptor, inliers);
  }

  FeatureRegistrationResult result;
  result.frame_from_reference = estimate->reference_from_frame;
  result.corner_covariance = estimate->corner_covariance;
  result.matches = by_descriptor;
  result.inliers = inliers;
  result.residual_px = estimate->residual_px;
  result.overlap = OverlapShare(result.frame_from_reference, reference.width, reference.height,
                                frame.width, frame.height);
  const bool valid = IsEnough(agreeing, by_descriptor, kValidShare) &&
                     WorstCornerSigma(result.corner_covariance) <= options_.inlier_distance_px;
  result.quality = valid ? RegistrationQuality::kValid : RegistrationQuality::kDegraded;
  return result;
}

}  // namespace windhover
