// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "replay/scoring/registration_score.h"

namespace windhover::replay {
namespace {

Eigen::Matrix3d Shift(double x, double y) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix(0, 2) = x;
  matrix(1, 2) = y;
  return matrix;
}

TEST(RegistrationScore, AShiftIsItsOwnLength) {
  EXPECT_NEAR(RegistrationRms(Shift(3, 4), Shift(0, 0), 640, 480).value(), 5, 1e-12);
  EXPECT_EQ(RegistrationRms(Shift(7, -3), Shift(7, -3), 640, 480), 0);
}

TEST(RegistrationScore, AStretchByHand) {
  // x' = 1.01 x over 0..100: the error is 0.01 x, and its mean square over eq. spaced points
  // x = 0, 100/12, ..., 100 is 1e-4 * 1e4 * (sum of i^2, 0..12) / (13 * 144).
  Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();
  stretch(0, 0) = 1.01;
  EXPECT_NEAR(RegistrationRms(stretch, Shift(0, 0), 101, 101).value(),
              std::sqrt(650.0 / (13 * 144)), 1e-12);
}

TEST(RegistrationScore, OnlyGroundThatBothSeeCounts) {
  // Truth moves all but the left half out; the error lies on the right and so is not seen.
  Eigen::Matrix3d bent = Shift(320, 0);
  bent(2, 0) = 1e-4;
  const double all = RegistrationRms(bent, Shift(0, 0), 640, 480).value();
  const double half = RegistrationRms(bent, Shift(320, 0), 640, 480).value();
  EXPECT_GT(all, half);
  EXPECT_EQ(RegistrationRms(bent, Shift(700, 0), 640, 480), std::nullopt);
}

TEST(RegistrationScore, GroundSentBehindTheCameraIsInfinitelyWrong) {
  Eigen::Matrix3d wild = Eigen::Matrix3d::Identity();
  wild(2, 0) = -1.0 / 300;
  EXPECT_EQ(RegistrationRms(wild, Shift(0, 0), 640, 480), std::numeric_limits<double>::infinity());
}

TEST(RegistrationScore, ConsecutiveErrorsAndDriftByHand) {
  // Truth: 10 px to the right a frame. Measured: 10, then 13, then 10: one pair is 3 px wrong, and
  // the end has drifted by 3 px.
  const std::vector<Eigen::Matrix3d> truth = {Shift(0, 0), Shift(10, 0), Shift(20, 0),
                                              Shift(30, 0)};
  const std::vector<Eigen::Matrix3d> measured = {Shift(0, 0), Shift(10, 0), Shift(23, 0),
                                                 Shift(33, 0)};
  const RegistrationScore score = ScoreRegistration(measured, truth, 640, 480);
  ASSERT_EQ(score.rms_px.size(), 3U);
  EXPECT_NEAR(score.rms_px[0].value(), 0, 1e-9);
  EXPECT_NEAR(score.rms_px[1].value(), 3, 1e-9);
  EXPECT_NEAR(score.rms_px[2].value(), 0, 1e-9);
  EXPECT_EQ(score.pairs, 3);
  EXPECT_EQ(score.without_ground, 0);
  EXPECT_NEAR(score.mean_px.value(), 1, 1e-9);
  EXPECT_NEAR(score.max_px.value(), 3, 1e-9);
  EXPECT_EQ(score.failures, 1);
  EXPECT_NEAR(score.drift_px, 3, 1e-9);
}

TEST(RegistrationScore, TheFirstFrameOfTheMeasurementIsFree) {
  // Only what happens between frames counts, not where the measurement starts.
  const std::vector<Eigen::Matrix3d> truth = {Shift(0, 0), Shift(10, 0)};
  const std::vector<Eigen::Matrix3d> measured = {Shift(5, 5), Shift(15, 5)};
  const RegistrationScore score = ScoreRegistration(measured, truth, 640, 480);
  EXPECT_NEAR(score.max_px.value(), 0, 1e-9);
  EXPECT_NEAR(score.drift_px, 0, 1e-9);
}

TEST(RegistrationScore, PairsWithoutCommonGroundAreCountedAndLeftOut) {
  // Truth jumps by more than the picture once; the other pair is 3 px wrong, and so is the mean.
  const std::vector<Eigen::Matrix3d> truth = {Shift(0, 0), Shift(700, 0), Shift(710, 0)};
  const std::vector<Eigen::Matrix3d> measured = {Shift(0, 0), Shift(10, 0), Shift(23, 0)};
  const RegistrationScore score = ScoreRegistration(measured, truth, 640, 480);
  ASSERT_EQ(score.rms_px.size(), 2U);
  EXPECT_EQ(score.rms_px[0], std::nullopt);
  EXPECT_EQ(score.pairs, 1);
  EXPECT_EQ(score.without_ground, 1);
  EXPECT_NEAR(score.mean_px.value(), 3, 1e-9);
  EXPECT_NEAR(score.max_px.value(), 3, 1e-9);
  EXPECT_EQ(score.failures, 1);

  const RegistrationScore none =
      ScoreRegistration({Shift(0, 0), Shift(1, 0)}, {Shift(0, 0), Shift(0, 500)}, 640, 480);
  EXPECT_EQ(none.pairs, 0);
  EXPECT_EQ(none.without_ground, 1);
  EXPECT_FALSE(none.mean_px);
  EXPECT_FALSE(none.max_px);
}

TEST(RegistrationScore, EmptyAndUnequal) {
  EXPECT_EQ(ScoreRegistration({}, {}, 640, 480).failures, 0);
  EXPECT_TRUE(ScoreRegistration({Shift(0, 0)}, {Shift(0, 0)}, 640, 480).rms_px.empty());
  EXPECT_THROW(ScoreRegistration({Shift(0, 0)}, {}, 640, 480), std::invalid_argument);
}

TEST(RegistrationScore, TheScaleOfAHomographyDoesNotMatter) {
  // h33 is 0: pixel 0 of one picture lies at infinity of the other.
  Eigen::Matrix3d steep = Eigen::Matrix3d::Zero();
  steep << 100, 0, -1, 0, 100, 0, 1, 0, 0;
  ASSERT_GT(steep.determinant(), 0);
  const Eigen::Matrix3d shifted = Shift(3, 4) * steep;
  // Pixels (x, y), x > 0, lie at (100 - 1 / x, 100 y / x).
  for (const double scale : {1.0, 1e-9, -7.0, 1e6}) {
    EXPECT_NEAR(RegistrationRms(shifted * scale, steep, 640, 480).value(), 5, 1e-9) << scale;
    EXPECT_NEAR(RegistrationRms(shifted, steep * scale, 640, 480).value(), 5, 1e-9) << scale;
    const RegistrationScore score = ScoreRegistration(
        {Shift(0, 0), Shift(13, 0) * scale}, {Shift(0, 0) * scale, Shift(10, 0)}, 640, 480);
    EXPECT_NEAR(score.max_px.value(), 3, 1e-9) << scale;
    EXPECT_NEAR(score.drift_px, 3, 1e-9) << scale;
  }
}

TEST(RegistrationScore, SkyDoesNotCount) {
  // Wrong by x' = x + 6 v / 100 below row 200 of 0..400, which is sky up to there: rows 208, 216,
  // ..., 400, at v = 8 i, i = 1 .. 25 give a mean square of (0.06 * 8)^2 * sum of i^2 / 25.
  Eigen::Matrix3d slant = Eigen::Matrix3d::Identity();
  slant(0, 1) = 0.06;
  slant(0, 2) = -12;
  const Eigen::Vector3d below(0, 1, -200);
  const Eigen::Matrix3d still = Eigen::Matrix3d::Identity();
  const double expected = 0.48 * std::sqrt(25 * 26 * 51 / 6.0 / 25);
  EXPECT_NEAR(RegistrationRms(slant, still, 401, 401, {below, below}).value(), expected, 1e-9);
  EXPECT_NEAR(RegistrationRms(slant, still, 401, 401, {below, std::nullopt}).value(), expected,
              1e-9);
  EXPECT_NEAR(RegistrationRms(slant, still, 401, 401, {std::nullopt, below}).value(), expected,
              1e-9);
  const Eigen::Vector3d nowhere(0, 1, -500);
  EXPECT_EQ(RegistrationRms(slant, still, 401, 401, {nowhere, below}), std::nullopt);
}

TEST(RegistrationScore, EachFrameHasItsOwnHorizon) {
  // The second frame's error is in its sky alone, the third frame shows no ground.
  Eigen::Matrix3d bent = Eigen::Matrix3d::Identity();
  bent(0, 1) = 0.1;
  const std::vector<Eigen::Matrix3d> truth(3, Eigen::Matrix3d::Identity());
  const std::vector<Eigen::Matrix3d> measured = {truth[0], bent, bent};
  const std::vector<Eigen::Vector3d> horizons = {{0, -1, 1000}, {0, -1, 0.5}, {0, 1, -1000}};
  const RegistrationScore score = ScoreRegistration(measured, truth, 401, 401, 1, horizons);
  EXPECT_NEAR(score.rms_px[0].value(), 0, 1e-9);  // row 0 alone
  EXPECT_EQ(score.rms_px[1], std::nullopt);
  EXPECT_EQ(score.pairs, 1);
  ASSERT_EQ(score.drifts_px.size(), 3U);
  EXPECT_NEAR(score.drifts_px[1].value(), 0, 1e-9);
  EXPECT_EQ(score.drifts_px[2], std::nullopt);
  EXPECT_EQ(score.drift_px, 0);
  EXPECT_THROW(ScoreRegistration(measured, truth, 401, 401, 1, {horizons.data(), 2}),
               std::invalid_argument);
}

TEST(RegistrationScore, OverAGapErrorsAddUp) {
  // 1 px too far each frame: 3 px over three frames, in each of the two pairs.
  std::vector<Eigen::Matrix3d> truth;
  std::vector<Eigen::Matrix3d> measured;
  for (int i = 0; i < 5; ++i) {
    truth.push_back(Shift(10 * i, 0));
    measured.push_back(Shift(11 * i, 0));
  }
  const RegistrationScore score = ScoreRegistration(measured, truth, 640, 480, 3);
  ASSERT_EQ(score.rms_px.size(), 2U);
  EXPECT_EQ(score.gap, 3);
  EXPECT_NEAR(score.mean_px.value(), 3, 1e-9);
  EXPECT_EQ(score.failures, 2);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(score.drifts_px[i].value(), i, 1e-9);
  EXPECT_NEAR(score.drift_px, 4, 1e-9);
  EXPECT_TRUE(ScoreRegistration(measured, truth, 640, 480, 5).rms_px.empty());
  EXPECT_THROW(ScoreRegistration(measured, truth, 640, 480, 0), std::invalid_argument);
}

TEST(RegistrationScore, TheMedianIsNotMovedByOneFailure) {
  const std::vector<Eigen::Matrix3d> truth(5, Eigen::Matrix3d::Identity());
  const std::vector<Eigen::Matrix3d> measured = {Shift(0, 0), Shift(1, 0), Shift(3, 0),
                                                 Shift(103, 0), Shift(103.5, 0)};
  // 1, 2, 100 and 0.5 px; one is above, none at the limit of 2.
  const RegistrationScore score = ScoreRegistration(measured, truth, 640, 480);
  EXPECT_NEAR(score.median_px.value(), 1.5, 1e-9);
  EXPECT_NEAR(score.mean_px.value(), 103.5 / 4, 1e-9);
}

}  // namespace
}  // namespace windhover::replay
