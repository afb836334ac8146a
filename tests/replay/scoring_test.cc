// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "replay/scoring/motion_score.h"
#include "replay/scoring/registration_score.h"

namespace windhover::replay {
namespace {

LabelledBox At(int frame, double x, double y, double width = 10, double height = 10,
               double score = 1) {
  return {frame, -1, {x, y, width, height}, score};
}

TEST(Overlap, IsIntersectionOverUnion) {
  const Box box = {0, 0, 10, 10};
  EXPECT_EQ(Overlap(box, box), 1);
  EXPECT_DOUBLE_EQ(Overlap(box, {5, 0, 10, 10}), 50.0 / 150);
  EXPECT_EQ(Overlap(box, {10, 0, 10, 10}), 0);
  EXPECT_DOUBLE_EQ(Overlap(box, {2, 2, 5, 4}), 0.2);
}

TEST(MotionScore, CountsByHand) {
  // Frame 1: two objects, one found, one false alarm. Frame 2: one object, found.
  const std::vector<LabelledBox> truth = {At(1, 0, 0), At(1, 50, 0), At(2, 0, 0)};
  const std::vector<LabelledBox> found = {At(2, 4, 4), At(1, 1, 0), At(1, 90, 90)};
  const MotionScore score = ScoreMotion(truth, found);
  EXPECT_EQ(score.truth, 3);
  EXPECT_EQ(score.detections, 3);
  EXPECT_EQ(score.hits, 2);
  EXPECT_DOUBLE_EQ(*score.precision(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(*score.recall(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(*score.f1(), 2.0 / 3);
}

TEST(MotionScore, EmptySidesHaveNoRatio) {
  const MotionScore nothing = ScoreMotion({}, {});
  EXPECT_FALSE(nothing.precision());
  EXPECT_FALSE(nothing.recall());
  EXPECT_FALSE(nothing.f1());
  const MotionScore silent = ScoreMotion({At(1, 0, 0)}, {});
  EXPECT_FALSE(silent.precision());
  EXPECT_EQ(*silent.recall(), 0);
  EXPECT_EQ(*silent.f1(), 0);
  const MotionScore noisy = ScoreMotion({}, {At(1, 0, 0)});
  EXPECT_EQ(*noisy.precision(), 0);
  EXPECT_FALSE(noisy.recall());
}

TEST(MotionScore, ADuplicateIsAFalseAlarm) {
  const MotionScore score = ScoreMotion({At(1, 0, 0)}, {At(1, 0, 0), At(1, 0, 0), At(1, 1, 1)});
  EXPECT_EQ(score.hits, 1);
  EXPECT_EQ(score.detections, 3);
}

TEST(MotionScore, OneBoxOverTwoObjectsIsOneHit) {
  const MotionScore score = ScoreMotion({At(1, 0, 0), At(1, 12, 0)}, {At(1, 0, 0, 22, 10)});
  EXPECT_EQ(score.hits, 1);
  EXPECT_EQ(score.truth, 2);
}

TEST(MotionScore, AHitExceedsTheLeastOverlap) {
  // 10 of 190: 0.0526. 9 of 191: 0.0471. 50 of 150: exactly a third.
  EXPECT_EQ(ScoreMotion({At(1, 0, 0)}, {At(1, 9, 0)}).hits, 1);
  EXPECT_EQ(ScoreMotion({At(1, 0, 0)}, {At(1, 9.1, 0)}).hits, 0);
  EXPECT_EQ(ScoreMotion({At(1, 0, 0)}, {At(1, 5, 0)}, 50.0 / 150).hits, 0);
}

TEST(MotionScore, AsManyPairsAsPossible) {
  // The first detection overlaps both objects, the left one more; the second only the left one.
  // Taking the best pair first and no more would leave the right object alone.
  const std::vector<LabelledBox> truth = {At(1, 0, 0), At(1, 8, 0)};
  const std::vector<LabelledBox> found = {At(1, 1, 0), At(1, -8, 0)};
  const MotionScore score = ScoreMotion(truth, found);
  EXPECT_EQ(score.hits, 2);
}

TEST(MotionScore, LargerOverlapIsPairedFirst) {
  const FrameMatch match = MatchFrame({At(1, 0, 0)}, {At(1, 6, 0), At(1, 1, 0)}, 0.05);
  EXPECT_EQ(match.detection_of_truth[0], 1);
  EXPECT_EQ(match.truth_of_detection[0], FrameMatch::kMiss);
}

TEST(MotionScore, TruthThatDoesNotCountIsLeftOut) {
  const std::vector<LabelledBox> truth = {At(1, 0, 0), At(1, 50, 0, 10, 10, 0)};
  const MotionScore both = ScoreMotion(truth, {At(1, 0, 0), At(1, 51, 0)});
  EXPECT_EQ(both.truth, 1);
  EXPECT_EQ(both.detections, 1);
  EXPECT_EQ(both.hits, 1);
  EXPECT_EQ(*ScoreMotion(truth, {}).recall(), 0);
}

TEST(MotionScore, ADuplicateIsNoLessFalseBesideTruthThatDoesNotCount) {
  // The second detection lies on the object, and on its ignored neighbour by a sixth.
  const std::vector<LabelledBox> truth = {At(1, 0, 0), At(1, 8, 0, 10, 10, 0)};
  const MotionScore score = ScoreMotion(truth, {At(1, 0, 0), At(1, 1, 0)});
  EXPECT_EQ(score.hits, 1);
  EXPECT_EQ(score.detections, 2);
  // Not even where it lies on the neighbour by more than half.
  EXPECT_EQ(ScoreMotion(truth, {At(1, 0, 0), At(1, 5, 0)}).detections, 2);
}

TEST(MotionScore, AFalseAlarmAroundTruthThatDoesNotCountIsOne) {
  const std::vector<LabelledBox> truth = {At(1, 15, 15, 10, 10, 0)};
  EXPECT_EQ(ScoreMotion(truth, {At(1, 0, 0, 40, 40)}).detections, 1);
}

TEST(MotionScore, ADetectionWithinLargeTruthThatDoesNotCountIsIgnored) {
  const std::vector<LabelledBox> truth = {At(1, 0, 0, 200, 200, 0)};
  EXPECT_EQ(ScoreMotion(truth, {At(1, 100, 100)}).detections, 0);
  // By half of its area, not less.
  EXPECT_EQ(ScoreMotion(truth, {At(1, 195, 100)}).detections, 0);
  EXPECT_EQ(ScoreMotion(truth, {At(1, 195.1, 100)}).detections, 1);
}

TEST(MotionScore, TruthThatDoesNotCountCoversTogetherAndOnlyOnce) {
  // Two quarters side by side are a half; the same quarter twice is a quarter.
  const LabelledBox left = At(1, 0, 0, 5, 5, 0);
  const LabelledBox right = At(1, 5, 0, 5, 5, 0);
  EXPECT_EQ(ScoreMotion({left, right}, {At(1, 0, 0)}).detections, 0);
  EXPECT_EQ(ScoreMotion({left, left}, {At(1, 0, 0)}).detections, 1);
  EXPECT_EQ(ScoreMotion({left, At(1, 0, 2, 5, 6, 0)}, {At(1, 0, 0)}).detections, 1);
  EXPECT_EQ(ScoreMotion({left, At(1, 0, 4, 5, 6, 0)}, {At(1, 0, 0)}).detections, 0);
}

TEST(MotionScore, FramesAreApart) { EXPECT_EQ(ScoreMotion({At(1, 0, 0)}, {At(2, 0, 0)}).hits, 0); }

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

}  // namespace
}  // namespace windhover::replay
