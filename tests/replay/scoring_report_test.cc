// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "replay/scoring/motion_report.h"
#include "replay/scoring/object_classes.h"
#include "replay/scoring/track_score.h"

namespace windhover::replay {
namespace {

LabelledBox At(int frame, std::int64_t id, double x, double y, double width = 10,
               double height = 10, double score = 1) {
  return {frame, id, {x, y, width, height}, score};
}

std::optional<TrackScore> Tracks(const std::vector<LabelledBox>& truth,
                                 const std::vector<LabelledBox>& found) {
  return ScoreTracks(BoxesByFrame(truth, found), HitRule::ByOverlap(kThesisOverlap));
}

TEST(TrackScore, ASwitchIsAnotherIdThanBefore) {
  const std::vector<LabelledBox> truth = {At(1, 5, 0, 0), At(2, 5, 0, 0), At(3, 5, 0, 0),
                                          At(4, 5, 0, 0)};
  const auto score =
      Tracks(truth, {At(1, 1, 0, 0), At(2, 1, 0, 0), At(3, 2, 0, 0), At(4, 1, 0, 0)});
  EXPECT_EQ(score->objects, 1);
  EXPECT_EQ(score->id_switches, 2);
  EXPECT_EQ(score->fragmentations, 0);
}

TEST(TrackScore, AnObjectKeepsItsTrackWhereABetterOneComes) {
  // Track 2 fits better from frame 2 on; track 1 is still allowed.
  const std::vector<LabelledBox> truth = {At(1, 5, 0, 0), At(2, 5, 0, 0)};
  EXPECT_EQ(Tracks(truth, {At(1, 1, 4, 0), At(2, 2, 0, 0), At(2, 1, 4, 0)})->id_switches, 0);
  // It is not any more.
  EXPECT_EQ(Tracks(truth, {At(1, 1, 4, 0), At(2, 2, 0, 0), At(2, 1, 40, 0)})->id_switches, 1);
}

TEST(TrackScore, ASwitchIsSeenAcrossAGap) {
  const std::vector<LabelledBox> truth = {At(1, 5, 0, 0), At(2, 5, 0, 0), At(3, 5, 0, 0)};
  const auto other = Tracks(truth, {At(1, 1, 0, 0), At(3, 2, 0, 0)});
  EXPECT_EQ(other->id_switches, 1);
  EXPECT_EQ(other->fragmentations, 1);
  const auto same = Tracks(truth, {At(1, 1, 0, 0), At(3, 1, 0, 0)});
  EXPECT_EQ(same->id_switches, 0);
  EXPECT_EQ(same->fragmentations, 1);
}

TEST(TrackScore, ObjectsThatSwapTracksAreTwoSwitches) {
  const std::vector<LabelledBox> truth = {At(1, 1, 0, 0), At(1, 2, 50, 0), At(2, 1, 0, 0),
                                          At(2, 2, 50, 0)};
  const auto score =
      Tracks(truth, {At(1, 7, 0, 0), At(1, 8, 50, 0), At(2, 8, 0, 0), At(2, 7, 50, 0)});
  EXPECT_EQ(score->objects, 2);
  EXPECT_EQ(score->id_switches, 2);
}

TEST(TrackScore, WhereAnObjectDoesNotCountNothingIsLost) {
  // Hidden in frame 2 and not labelled in frame 3: found in all frames that count.
  const std::vector<LabelledBox> truth = {At(1, 5, 0, 0), At(2, 5, 0, 0, 10, 10, 0),
                                          At(4, 5, 0, 0)};
  const auto score = Tracks(truth, {At(1, 1, 0, 0), At(4, 1, 0, 0)});
  EXPECT_EQ(score->objects, 1);
  EXPECT_EQ(score->fragmentations, 0);
  EXPECT_EQ(score->id_switches, 0);
}

TEST(TrackScore, MissedAtTheStartOrTheEndIsNoFragmentation) {
  const std::vector<LabelledBox> truth = {At(1, 5, 0, 0), At(2, 5, 0, 0), At(3, 5, 0, 0)};
  EXPECT_EQ(Tracks(truth, {At(2, 1, 0, 0)})->fragmentations, 0);
}

TEST(TrackScore, NeedsIdentities) {
  EXPECT_FALSE(Tracks({At(1, -1, 0, 0)}, {At(1, 1, 0, 0)}));
  EXPECT_FALSE(Tracks({At(1, 1, 0, 0)}, {At(1, -1, 0, 0)}));
  // What does not count needs none.
  EXPECT_TRUE(Tracks({At(1, -1, 0, 0, 10, 10, 0)}, {At(1, 1, 0, 0)}));
  EXPECT_EQ(Tracks({}, {})->objects, 0);
  EXPECT_EQ(Tracks({At(1, 1, 0, 0)}, {})->objects, 1);
}

TEST(Classes, BySizeOfTheBox) {
  // 4 x 9 is 6 px; 8 x 8 is 8 px and belongs to the class that starts there; 64 x 16 is 32.
  const std::vector<LabelledBox> truth = {At(1, 1, 0, 0, 4, 9), At(1, 2, 50, 0, 8, 8),
                                          At(1, 3, 100, 0, 64, 16), At(1, 4, 200, 0, 20, 20),
                                          At(1, 5, 300, 0, 20, 20, 0)};
  const std::vector<LabelledBox> found = {At(1, 1, 0, 0, 4, 9), At(1, 3, 100, 0, 64, 16)};
  const std::vector<FrameBoxes> frames = BoxesByFrame(truth, found);
  const auto classes = RecallBySize(frames, MatchFrames(frames, HitRule::ByOverlap(0.05)));
  ASSERT_EQ(classes.size(), 4U);
  const std::vector<int> truth_counts = {1, 1, 1, 1};
  const std::vector<int> hit_counts = {1, 0, 0, 1};
  for (std::size_t i = 0; i < classes.size(); ++i) {
    EXPECT_EQ(classes[i].truth, truth_counts[i]) << i;
    EXPECT_EQ(classes[i].hits, hit_counts[i]) << i;
  }
  EXPECT_EQ(classes[0].below, 8);
  EXPECT_EQ(classes[3].least, 32);
  EXPECT_FALSE(classes[3].below);
}

TEST(Classes, AClassWithoutTruthHasNoRecall) {
  EXPECT_FALSE(ClassRecall{}.recall());
  EXPECT_EQ((ClassRecall{0, std::nullopt, 4, 1}.recall()), 0.25);
}

// An object at x = 3 f in the picture of frame f, for frames 1 to `last`.
std::vector<FrameBoxes> ThreePxAFrame(int last) {
  std::vector<LabelledBox> truth;
  for (int frame = 1; frame <= last; ++frame) truth.push_back(At(frame, 1, 3 * frame, 20));
  return BoxesByFrame(truth, {});
}

TEST(GroundSpeeds, OfAStandingCameraAreThoseInThePicture) {
  const auto speeds = GroundSpeeds(ThreePxAFrame(20), {});
  ASSERT_EQ(speeds.size(), 20U);
  for (const auto& frame : speeds) EXPECT_DOUBLE_EQ(frame.at(0).value(), 3);
}

TEST(GroundSpeeds, TakeOutTheCamera) {
  // The ground slides by 2 px a frame to the right in the picture, so the object does 1 px.
  std::vector<Eigen::Matrix3d> first_from_frame;
  for (int frame = 1; frame <= 20; ++frame) {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
    matrix(0, 2) = -2 * (frame - 1);
    first_from_frame.push_back(matrix * (frame % 2 == 0 ? -3.0 : 0.5));
  }
  for (const auto& frame : GroundSpeeds(ThreePxAFrame(20), first_from_frame)) {
    EXPECT_NEAR(frame.at(0).value(), 1, 1e-9);
  }
  first_from_frame.pop_back();
  EXPECT_THROW(GroundSpeeds(ThreePxAFrame(20), first_from_frame), std::invalid_argument);
}

TEST(GroundSpeeds, AreInPixelsOfTheirOwnFrame) {
  // Each frame's pixels are twice as large on the ground as those of the first one.
  std::vector<Eigen::Matrix3d> first_from_frame = {Eigen::Matrix3d::Identity(),
                                                   Eigen::Matrix3d::Identity()};
  first_from_frame[1](0, 0) = first_from_frame[1](1, 1) = 2;
  // Middle at 10 of the first frame, and at 20 of the first one (10 of its own) in the second.
  const std::vector<LabelledBox> truth = {At(1, 1, 5.5, 5.5), At(2, 1, 5.5, 5.5)};
  const auto speeds = GroundSpeeds(BoxesByFrame(truth, {}), first_from_frame);
  EXPECT_NEAR(speeds[0][0].value(), std::hypot(10, 10), 1e-9);
  EXPECT_NEAR(speeds[1][0].value(), std::hypot(5, 5), 1e-9);
}

TEST(GroundSpeeds, OfWhatIsSeenOnceAreUnknown) {
  const std::vector<LabelledBox> truth = {At(1, 1, 0, 0), At(1, -1, 50, 0), At(2, -1, 60, 0),
                                          At(7, 1, 60, 0)};
  for (const auto& frame : GroundSpeeds(BoxesByFrame(truth, {}), {})) {
    for (const auto& speed : frame) EXPECT_FALSE(speed);
  }
}

MotionTruth Truth(std::vector<LabelledBox> boxes) {
  MotionTruth truth;
  truth.boxes = std::move(boxes);
  truth.frames = 50;
  truth.width = 640;
  truth.height = 480;
  truth.frame_rate_hz = 25;
  return truth;
}

TEST(MotionReport, HasAllFiguresOfOneSequence) {
  // Overlaps: a third, 1, and a false alarm in a frame of its own.
  const MotionTruth truth = Truth({At(1, 1, 0, 0), At(1, 2, 50, 0), At(2, 1, 0, 0)});
  const std::vector<LabelledBox> found = {At(1, 1, 5, 0), At(1, 2, 50, 0), At(9, 3, 90, 90)};
  const MotionReport report =
      ReportMotion(truth, found, DefaultOverlaps(MotionProtocol::kWindhover));
  ASSERT_EQ(report.at_overlap.size(), 3U);
  EXPECT_EQ(report.at_overlap[0].least_overlap, 0.05);
  EXPECT_EQ(report.at_overlap[0].score.hits, 2);
  EXPECT_EQ(report.at_overlap[1].score.hits, 2);
  EXPECT_EQ(report.at_overlap[2].least_overlap, 0.5);
  EXPECT_EQ(report.at_overlap[2].score.hits, 1);
  EXPECT_EQ(report.centre.hits, 2);
  // One in 2 s.
  EXPECT_DOUBLE_EQ(report.false_alarms_a_minute().value(), 30);
  EXPECT_DOUBLE_EQ(report.detections_a_frame(), 3.0 / 50);
  EXPECT_EQ(report.tracks->objects, 2);
  EXPECT_EQ(report.by_size[1].truth, 3);
  EXPECT_TRUE(report.by_speed.empty());
}

TEST(MotionReport, WithoutRateOrCompleteTruthThereAreNoFalseAlarms) {
  MotionTruth truth = Truth({At(1, 1, 0, 0)});
  const std::vector<double> overlaps = {0.5};
  truth.frame_rate_hz.reset();
  EXPECT_FALSE(ReportMotion(truth, {}, overlaps).false_alarms_a_minute());
  truth.frame_rate_hz = 25;
  EXPECT_EQ(ReportMotion(truth, {}, overlaps).false_alarms_a_minute(), 0);
  truth.complete = false;
  EXPECT_FALSE(ReportMotion(truth, {}, overlaps).false_alarms_a_minute());
}

TEST(MotionReport, RefusesNothing) {
  MotionTruth truth = Truth({});
  EXPECT_THROW(ReportMotion(truth, {}, {}), std::invalid_argument);
  const std::vector<double> overlaps = {0.5};
  EXPECT_EQ(ReportMotion(truth, {}, overlaps).score().truth, 0);
  truth.frames = 0;
  EXPECT_THROW(ReportMotion(truth, {}, overlaps), std::invalid_argument);
  EXPECT_THROW(Pool({}), std::invalid_argument);
  EXPECT_THROW(MeanOf({}), std::invalid_argument);
}

TEST(MotionReport, MeanAndPooledDiffer) {
  // One of one, and one of three with two false alarms; a third one says and shows nothing.
  const std::vector<double> overlaps = {0.05, 0.5};
  std::vector<MotionReport> reports = {
      ReportMotion(Truth({At(1, 1, 0, 0)}), {At(1, 1, 0, 0)}, overlaps),
      ReportMotion(Truth({At(1, 1, 0, 0), At(2, 1, 0, 0), At(3, 1, 0, 0)}),
                   {At(1, 1, 0, 0), At(1, 2, 90, 0), At(2, 2, 90, 0)}, overlaps),
      ReportMotion(Truth({}), {}, overlaps)};
  const MotionReport pooled = Pool(reports);
  EXPECT_EQ(pooled.frames, 150);
  EXPECT_EQ(pooled.score().truth, 4);
  EXPECT_EQ(pooled.score().detections, 4);
  EXPECT_DOUBLE_EQ(pooled.score().precision().value(), 0.5);
  EXPECT_DOUBLE_EQ(pooled.score().f1().value(), 0.5);
  EXPECT_DOUBLE_EQ(pooled.false_alarms_a_minute().value(), 2 / 0.1);
  EXPECT_EQ(pooled.tracks->objects, 2);
  EXPECT_EQ(pooled.by_size[1].truth, 4);
  const MotionMean mean = MeanOf(reports);
  ASSERT_EQ(mean.at_overlap.size(), 2U);
  EXPECT_DOUBLE_EQ(mean.at_overlap[0].precision.value(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(mean.at_overlap[0].recall.value(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(mean.at_overlap[0].f1.value(), 2.0 / 3);
  EXPECT_DOUBLE_EQ(mean.false_alarms_a_minute.value(), 20);  // 0, 60, 0

  reports[0].tracks.reset();
  reports[1].minutes.reset();
  EXPECT_FALSE(Pool(reports).tracks);
  EXPECT_FALSE(Pool(reports).minutes);
  const std::vector<double> others = {0.05, 0.6};
  reports.push_back(ReportMotion(Truth({}), {}, others));
  EXPECT_THROW(Pool(reports), std::invalid_argument);
}

TEST(MotionReport, AnIncompleteSequenceHasNoPartInThePrecisionOfTheMean) {
  const std::vector<double> overlaps = {0.05};
  MotionTruth one_target = Truth({At(1, 1, 0, 0)});
  one_target.complete = false;
  const std::vector<MotionReport> reports = {
      ReportMotion(one_target, {At(1, 1, 90, 0)}, overlaps),
      ReportMotion(Truth({At(1, 1, 0, 0)}), {At(1, 1, 0, 0)}, overlaps)};
  const MotionMean mean = MeanOf(reports);
  EXPECT_DOUBLE_EQ(mean.at_overlap[0].precision.value(), 1);
  EXPECT_DOUBLE_EQ(mean.at_overlap[0].recall.value(), 0.5);
  EXPECT_FALSE(Pool(reports).complete);
}

TEST(Pesmod, DropsSmallDetectionsAndThoseAtTheBorder) {
  const std::vector<LabelledBox> found = {At(1, 1, 5, 5),            // 5 px from both borders
                                          At(1, 2, 4.9, 50),         // left
                                          At(1, 3, 50, 4.9),         // top
                                          At(1, 4, 625, 465),        // 5 px from right and bottom
                                          At(1, 5, 625.1, 100),      // right
                                          At(1, 6, 100, 465.1),      // bottom
                                          At(1, 7, 100, 100, 2, 5),  // 10 px^2
                                          At(1, 8, 200, 100, 2, 5.1)};  // more
  const auto kept = ApplyProtocol(MotionProtocol::kPesmod, found, 640, 480);
  std::vector<std::int64_t> ids;
  for (const LabelledBox& box : kept) ids.push_back(box.id);
  EXPECT_EQ(ids, (std::vector<std::int64_t>{1, 4, 8}));
  EXPECT_EQ(ApplyProtocol(MotionProtocol::kWindhover, found, 640, 480).size(), found.size());
}

TEST(Pesmod, TruthAtTheBorderCounts) {
  const MotionTruth truth = Truth({At(1, 1, 0, 0), At(1, 2, 50, 50)});
  const MotionReport report =
      ReportMotion(truth, {At(1, 1, 0, 0), At(1, 2, 50, 50)},
                   DefaultOverlaps(MotionProtocol::kPesmod), MotionProtocol::kPesmod);
  EXPECT_EQ(report.at_overlap[0].least_overlap, 0.5);
  EXPECT_EQ(report.at_overlap[1].least_overlap, 0.25);
  EXPECT_EQ(report.score().truth, 2);
  EXPECT_EQ(report.score().detections, 1);
  EXPECT_EQ(report.score().hits, 1);
}

// As many frames and boxes as the whole of dataset B, with twice as many detections.
TEST(MotionReport, CountsOverManyFrames) {
  MotionTruth truth = Truth({});
  truth.frames = 4184;
  truth.first_from_frame.assign(4184, Eigen::Matrix3d::Identity());
  std::vector<LabelledBox> found;
  for (int frame = 1; frame <= truth.frames; ++frame) {
    for (int i = 0; i < 3; ++i) {
      truth.boxes.push_back(At(frame, i, 20 * i + frame % 100, 30));
      found.push_back(At(frame, i, 20 * i + frame % 100 + 2, 30));
      found.push_back(At(frame, 10 + i, 20 * i + frame % 100, 33));
    }
  }
  const MotionReport report =
      ReportMotion(truth, found, DefaultOverlaps(MotionProtocol::kWindhover));
  EXPECT_EQ(report.score().hits, 3 * 4184);
}

}  // namespace
}  // namespace windhover::replay
