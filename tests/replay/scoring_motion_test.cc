// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <vector>

#include "replay/scoring/frame_match.h"
#include "replay/scoring/motion_score.h"

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

TEST(CentreHits, LieWithinHalfTheDiagonal) {
  // 6 x 8: half a diagonal is 5 px. The middle is (3, 4).
  const std::vector<LabelledBox> truth = {At(1, 0, 0, 6, 8)};
  const auto hits = [&](double middle_x, double middle_y) {
    const std::vector<FrameBoxes> frames =
        BoxesByFrame(truth, std::vector<LabelledBox>{At(1, middle_x - 1, middle_y - 1, 2, 2)});
    return CountHits(MatchFrames(frames, HitRule::ByCentre())).hits;
  };
  EXPECT_EQ(hits(3, 4), 1);
  EXPECT_EQ(hits(8, 4), 1);
  EXPECT_EQ(hits(6, 8), 1);  // 3 to the right, 4 down: exactly 5
  EXPECT_EQ(hits(8.01, 4), 0);
}

TEST(CentreHits, ReachThreePixelsAroundTheSmallest) {
  const LabelledBox dot = At(1, 10, 10, 2, 2);  // middle at 11
  const HitRule rule = HitRule::ByCentre();
  EXPECT_GT(rule.Fit(dot.box, {13, 10, 2, 2}), 0);
  EXPECT_EQ(rule.Fit(dot.box, {13.1, 10, 2, 2}), 0);
  // However large the detection is.
  EXPECT_GT(rule.Fit(dot.box, {-89, -89, 200, 200}), 0);
}

TEST(CentreHits, TheCloserIsTakenAndTheOtherIsFalse) {
  const std::vector<LabelledBox> truth = {At(1, 0, 0)};
  const std::vector<LabelledBox> found = {At(1, 3, 0), At(1, 1, 0)};
  const FrameMatch match = MatchFrame(truth, found, HitRule::ByCentre());
  EXPECT_EQ(match.detection_of_truth[0], 1);
  EXPECT_EQ(match.truth_of_detection[0], FrameMatch::kMiss);
}

TEST(MatchFrame, TiesGoToTheFirst) {
  const FrameMatch match = MatchFrame({At(1, 0, 0)}, {At(1, 2, 0), At(1, -2, 0)}, 0.05);
  EXPECT_EQ(match.detection_of_truth[0], 0);
}

TEST(MatchFrame, KeptPairsGoBeforeBetterOnes) {
  const std::vector<LabelledBox> truth = {At(1, 0, 0)};
  const std::vector<LabelledBox> found = {At(1, 0, 0), At(1, 5, 0)};
  const std::vector<FramePair> kept = {{0, 1}};
  const FrameMatch match = MatchFrame(truth, found, HitRule::ByOverlap(0.05), kept);
  EXPECT_EQ(match.detection_of_truth[0], 1);
  EXPECT_EQ(match.truth_of_detection[0], FrameMatch::kMiss);
}

TEST(BoxesByFrame, ComeByNumberAndLeaveOutEmptyFrames) {
  const std::vector<LabelledBox> truth = {At(7, 0, 0), At(2, 1, 0)};
  const std::vector<LabelledBox> found = {At(7, 2, 0), At(4, 3, 0), At(7, 4, 0)};
  const std::vector<FrameBoxes> frames = BoxesByFrame(truth, found);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].number, 2);
  EXPECT_EQ(frames[1].number, 4);
  EXPECT_TRUE(frames[1].truth.empty());
  EXPECT_EQ(frames[2].number, 7);
  ASSERT_EQ(frames[2].detections.size(), 2U);
  EXPECT_EQ(frames[2].detections[1].box.x, 4);
}

}  // namespace
}  // namespace windhover::replay
