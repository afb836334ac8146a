// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "service/vision/homography.h"
#include "service/vision/homography_estimator.h"
#include "service/vision/homography_refiner.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;

Eigen::Matrix3d Motion(double radians, double zoom, double dx, double dy, double perspective) {
  return CameraMotion(kWidth, kHeight, radians, zoom, dx, dy, perspective);
}

std::vector<PointMatch> TileMatches(const Eigen::Matrix3d& reference_from_frame) {
  std::vector<PointMatch> matches;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      PointMatch match;
      match.x_in_frame << 63.5 + column * 102.4, 63.5 + row * 70.4;
      match.x_in_reference = Project(reference_from_frame, match.x_in_frame);
      match.covariance = 0.01 * Eigen::Matrix2d::Identity();
      matches.push_back(match);
    }
  }
  return matches;
}

double Rms(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return HomographyRms(a, b, kWidth, kHeight);
}

class Noise {
 public:
  explicit Noise(double sigma) : normal_(0.0, sigma) {}
  Eigen::Vector2d operator()() { return {normal_(random_), normal_(random_)}; }

 private:
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

const Eigen::Matrix3d kMotions[] = {Eigen::Matrix3d::Identity(), Motion(0, 1, 12.5, -40, 0),
                                    Motion(0.2, 1.1, -25, 7, 0), Motion(-0.05, 0.97, 3, 3, 1e-4),
                                    Motion(1.0, 0.8, 100, -80, 3e-4)};

TEST(HomographyDlt, Nominal) {
  for (const Eigen::Matrix3d& truth : kMotions) {
    const auto h = HomographyByDlt(TileMatches(truth), {});
    ASSERT_TRUE(h.has_value());
    EXPECT_LT(Rms(*h, truth), 1e-8);
    EXPECT_DOUBLE_EQ((*h)(2, 2), 1.0);
  }
}

TEST(HomographyDlt, UsesOnlyTheMarkedMatches) {
  auto matches = TileMatches(kMotions[2]);
  std::vector<std::uint8_t> use(matches.size(), 1);
  matches[7].x_in_reference.x() += 30;
  EXPECT_GT(Rms(*HomographyByDlt(matches, use), kMotions[2]), 0.1);
  use[7] = 0;
  EXPECT_LT(Rms(*HomographyByDlt(matches, use), kMotions[2]), 1e-8);
}

TEST(HomographyDlt, NumericalStability) {
  // A small picture far away from the origin is as good as one around it.
  const Eigen::Matrix3d truth = kMotions[3];
  auto matches = TileMatches(truth);
  Eigen::Matrix3d away = Eigen::Matrix3d::Identity();
  away.topRightCorner<2, 1>() << 1e5, -2e5;
  for (PointMatch& match : matches) {
    match.x_in_frame = Project(away, match.x_in_frame);
    match.x_in_reference = Project(away, match.x_in_reference);
  }
  const auto h = HomographyByDlt(matches, {});
  ASSERT_TRUE(h.has_value());
  EXPECT_LT(Rms(away.inverse() * *h * away, truth), 1e-4);
}

TEST(HomographyDlt, Degenerate) {
  auto matches = TileMatches(kMotions[1]);
  EXPECT_FALSE(HomographyByDlt(std::span(matches).first(3), {}).has_value());
  EXPECT_FALSE(HomographyByDlt(std::span(matches).first(6), {}).has_value());  // one row
  for (PointMatch& match : matches) match.x_in_frame = match.x_in_reference = {5, 5};
  EXPECT_FALSE(HomographyByDlt(matches, {}).has_value());
}

TEST(HomographyEstimatorTest, Nominal) {
  HomographyEstimator estimator(kWidth, kHeight, {});
  for (const Eigen::Matrix3d& truth : kMotions) {
    const auto estimate = estimator.Estimate(TileMatches(truth));
    ASSERT_TRUE(estimate.has_value());
    EXPECT_LT(Rms(estimate->reference_from_frame, truth), 1e-6);
    EXPECT_EQ(estimate->inliers, 36);
  }
}

TEST(HomographyEstimatorTest, NoiseStability) {
  HomographyEstimator estimator(kWidth, kHeight, {});
  for (const double sigma : {0.02, 0.1, 0.3}) {
    Noise noise(sigma);
    double sum = 0.0;
    constexpr int kTrials = 50;
    for (int trial = 0; trial < kTrials; ++trial) {
      auto matches = TileMatches(kMotions[3]);
      for (PointMatch& match : matches) match.x_in_reference += noise();
      const auto estimate = estimator.Estimate(matches);
      ASSERT_TRUE(estimate.has_value());
      sum += Rms(estimate->reference_from_frame, kMotions[3]);
    }
    // 72 measured coordinates, 8 parameters: the error of a least-squares fit over the area of the
    // points is sigma * sqrt(2 * 8 / 72), larger outside it.
    EXPECT_LT(sum / kTrials, 1.0 * sigma) << sigma;
  }
}

TEST(HomographyEstimatorTest, MismatchesDoNotMoveTheResult) {
  HomographyEstimator estimator(kWidth, kHeight, {});
  for (const int mismatches : {1, 8, 16}) {
    auto matches = TileMatches(kMotions[2]);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> anywhere(-60, 60);
    for (int i = 0; i < mismatches; ++i) {
      matches[(5 * i) % 36].x_in_reference +=
          Eigen::Vector2d(anywhere(random) + 70, anywhere(random));
    }
    const auto estimate = estimator.Estimate(matches);
    ASSERT_TRUE(estimate.has_value());
    EXPECT_EQ(estimate->inliers, 36 - mismatches);
    EXPECT_LT(Rms(estimate->reference_from_frame, kMotions[2]), 1e-5);
    for (int i = 0; i < mismatches; ++i) EXPECT_EQ(estimator.inliers()[(5 * i) % 36], 0);
  }
}

TEST(HomographyEstimatorTest, LeastMedianNeedsNoDistance) {
  // The distance asked for lets everything pass: it is taken from the matches themselves.
  HomographyEstimator estimator(kWidth, kHeight,
                                {.robust = RobustEstimator::kLmeds, .ransac_threshold_px = 500});
  Noise noise(0.2);
  for (const int mismatches : {0, 8, 14}) {
    auto matches = TileMatches(kMotions[2]);
    for (PointMatch& match : matches) match.x_in_reference += noise();
    for (int i = 0; i < mismatches; ++i) {
      matches[(5 * i) % 36].x_in_reference += Eigen::Vector2d(20 + 9 * i, 13 * (i % 5) - 30);
    }
    const auto estimate = estimator.Estimate(matches);
    ASSERT_TRUE(estimate.has_value());
    EXPECT_LT(Rms(estimate->reference_from_frame, kMotions[2]), 0.4) << mismatches;
    EXPECT_LE(estimate->inliers, 36 - mismatches);
    EXPECT_GE(estimate->inliers, 30 - mismatches);
    for (int i = 0; i < mismatches; ++i) EXPECT_EQ(estimator.inliers()[(5 * i) % 36], 0);
  }
}

TEST(HomographyEstimatorTest, LeastMedianKeepsToTheDistance) {
  HomographyEstimator estimator(kWidth, kHeight,
                                {.robust = RobustEstimator::kLmeds, .ransac_threshold_px = 0.5});
  auto matches = TileMatches(kMotions[1]);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-200, 200);
  for (PointMatch& match : matches) {
    match.x_in_reference += Eigen::Vector2d(anywhere(random), anywhere(random));
  }
  const auto estimate = estimator.Estimate(matches);
  EXPECT_LT(estimate ? estimate->inliers : 0, 9);
  EXPECT_FALSE(estimator.Estimate(std::span(matches).first(3)).has_value());
  EXPECT_FALSE(estimator.Estimate({}).has_value());
}

TEST(HomographyEstimatorTest, EstimatesFromWhatIsKnownRoughly) {
  HomographyEstimator estimator(kWidth, kHeight, {.ransac_threshold_px = 3});
  auto matches = TileMatches(kMotions[3]);
  matches[4].x_in_reference.x() += 40;
  Eigen::Matrix3d rough = kMotions[3];
  rough(0, 2) += 1.5;
  const auto estimate = estimator.EstimateFrom(rough, matches);
  ASSERT_TRUE(estimate.has_value());
  EXPECT_LT(Rms(estimate->reference_from_frame, kMotions[3]), 1e-3);
  EXPECT_EQ(estimate->inliers, 35);
  EXPECT_EQ(estimator.inliers()[4], 0);
  EXPECT_FALSE(estimator.EstimateFrom(rough, {}).has_value());
}

TEST(HomographyEstimatorTest, AFirstSampleOfMismatchesDoesNotEndTheSearch) {
  // The homography of four matches that agree with nothing else asks for billions of samples.
  HomographyEstimator estimator(kWidth, kHeight, {.max_ransac_iterations = 1000});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(0, kWidth - 1);
  std::uniform_real_distribution<double> y(0, kHeight - 1);
  for (const int wrong : {200, 350, 500}) {
    std::vector<PointMatch> matches(700);
    for (int i = 0; i < 700; ++i) {
      matches[i].x_in_frame << x(random), y(random);
      matches[i].x_in_reference = Project(kMotions[2], matches[i].x_in_frame);
      if (i < wrong) matches[i].x_in_reference = {x(random), y(random)};
    }
    const auto estimate = estimator.Estimate(matches);
    ASSERT_TRUE(estimate.has_value()) << wrong;
    EXPECT_LT(Rms(estimate->reference_from_frame, kMotions[2]), 0.01) << wrong;
  }
}

TEST(HomographyEstimatorTest, UncertainMatchesWeighLess) {
  // A third of the matches is blurred along x and lies off by 0.8 px there: the covariance-weighted
  // estimate follows the others, one that believes all alike does not (thesis 2.4.3).
  HomographyEstimator estimator(kWidth, kHeight, {});
  const Eigen::Matrix3d truth = kMotions[1];
  auto matches = TileMatches(truth);
  for (std::size_t i = 0; i < matches.size(); i += 3) matches[i].x_in_reference.x() += 0.8;
  const double alike = Rms(estimator.Estimate(matches)->reference_from_frame, truth);
  for (std::size_t i = 0; i < matches.size(); i += 3) matches[i].covariance(0, 0) = 1.0;
  const double weighted = Rms(estimator.Estimate(matches)->reference_from_frame, truth);
  EXPECT_GT(alike, 0.2);
  EXPECT_LT(weighted, 0.05);
}

TEST(HomographyEstimatorTest, GroundWinsOverWhatStandsOutOfIt) {
  // A third of the tiles sees roofs, which lie off along one direction by up to a pixel: all within
  // the RANSAC threshold, and none of it noise.
  HomographyEstimator estimator(kWidth, kHeight, {});
  Noise noise(0.04);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> parallax(0.2, 1.0);
  double sum = 0.0;
  constexpr int kTrials = 50;
  for (int trial = 0; trial < kTrials; ++trial) {
    auto matches = TileMatches(kMotions[1]);
    std::shuffle(matches.begin(), matches.end(), random);
    for (std::size_t i = 0; i < matches.size(); ++i) {
      matches[i].x_in_reference += noise();
      if (i < 12) matches[i].x_in_reference += parallax(random) * Eigen::Vector2d(0.6, -0.8);
    }
    const auto estimate = estimator.Estimate(matches);
    ASSERT_TRUE(estimate.has_value());
    sum += Rms(estimate->reference_from_frame, kMotions[1]);
  }
  EXPECT_LT(sum / kTrials, 0.06) << "px; weighing all alike gives 0.23";
}

TEST(HomographyEstimatorTest, CovarianceOfCornersIsThatOfTheScatter) {
  HomographyEstimator estimator(kWidth, kHeight, {});
  Noise noise(0.1);
  constexpr int kTrials = 400;
  double normalised = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    auto matches = TileMatches(kMotions[3]);
    for (PointMatch& match : matches) match.x_in_reference += noise();
    const auto estimate = estimator.Estimate(matches);
    ASSERT_TRUE(estimate.has_value());
    Eigen::Matrix<double, 8, 1> error;
    const auto corners = PictureCorners(kWidth, kHeight);
    for (int i = 0; i < 4; ++i) {
      error.segment<2>(2 * i) =
          Project(estimate->reference_from_frame, corners[i]) - Project(kMotions[3], corners[i]);
    }
    normalised += error.dot(estimate->corner_covariance.ldlt().solve(error));
  }
  // Expectation 8, a little more as the scatter is estimated from 64 degrees of freedom.
  EXPECT_NEAR(normalised / kTrials, 8.3, 1.0);
}

TEST(HomographyEstimatorTest, NumericalStability) {
  // Covariances over six orders of magnitude and an initial value far off.
  auto matches = TileMatches(kMotions[2]);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    matches[i].covariance *= std::pow(10.0, static_cast<double>(i % 7) - 3.0);
  }
  const auto fit =
      HomographyRefiner(kWidth, kHeight)
          .Refine(matches, Eigen::Matrix3d::Identity(), std::numeric_limits<double>::infinity());
  ASSERT_TRUE(fit.has_value());
  EXPECT_LT(Rms(fit->reference_from_frame, kMotions[2]), 1e-5);
  const Eigen::SelfAdjointEigenSolver<Matrix8d> solver(fit->corner_covariance);
  EXPECT_GE(solver.eigenvalues()[0], -1e-12);
}

TEST(HomographyEstimatorTest, Degenerate) {
  HomographyEstimator estimator(kWidth, kHeight, {});
  const auto matches = TileMatches(kMotions[1]);
  EXPECT_FALSE(estimator.Estimate({}).has_value());
  EXPECT_FALSE(estimator.Estimate(std::span(matches).first(3)).has_value());
  EXPECT_FALSE(estimator.Estimate(std::span(matches).first(6)).has_value());  // one row
  auto mirrored = matches;
  for (PointMatch& match : mirrored) match.x_in_reference.x() *= -1.0;
  EXPECT_FALSE(estimator.Estimate(mirrored).has_value());
  auto same = matches;
  for (PointMatch& match : same) match.x_in_frame = match.x_in_reference = {5, 5};
  EXPECT_FALSE(estimator.Estimate(same).has_value());
  auto not_a_number = matches;
  not_a_number[3].x_in_reference.x() = std::nan("");
  const auto estimate = estimator.Estimate(not_a_number);
  ASSERT_TRUE(estimate.has_value());
  EXPECT_EQ(estimate->inliers, 35);
  EXPECT_TRUE(estimate->reference_from_frame.allFinite());
}

TEST(Overlap, CountsTheSharedPicture) {
  const auto share = [](const Eigen::Matrix3d& m) {
    return OverlapShare(m, kWidth, kHeight, kWidth, kHeight);
  };
  EXPECT_DOUBLE_EQ(share(Eigen::Matrix3d::Identity()), 1.0);
  EXPECT_NEAR(share(Motion(0, 1, 320, 0, 0)), 0.5, 0.03);
  EXPECT_DOUBLE_EQ(share(Motion(0, 1, 0, 500, 0)), 0.0);
}

}  // namespace
}  // namespace windhover
