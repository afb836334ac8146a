// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "replay/readers/ground_motion.h"
#include "replay/readers/motion_filter.h"

namespace windhover::replay {
namespace {

constexpr int kFrames = 60;

// The ground slides 3 px left and 1 px up a frame and turns by one degree about (1000, 1000).
// Multiples of a homography are the same one.
Eigen::Matrix3d PreviousFromFrame() {
  const double angle = std::numbers::pi / 180;
  Eigen::Matrix3d turn;
  turn << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  Eigen::Matrix3d to_middle = Eigen::Matrix3d::Identity();
  to_middle.topRightCorner<2, 1>() = Eigen::Vector2d(-1000, -1000);
  Eigen::Matrix3d back = Eigen::Matrix3d::Identity();
  back.topRightCorner<2, 1>() = Eigen::Vector2d(1003, 1001);
  return back * turn * to_middle * -2.5;
}

GroundMotion Flight(int frames) {
  std::vector<Eigen::Matrix3d> first_from_frame = {Eigen::Matrix3d::Identity()};
  for (int i = 1; i < frames; ++i) {
    first_from_frame.push_back(first_from_frame.back() * PreviousFromFrame());
    first_from_frame.back().normalize();
  }
  return TrueGroundMotion(first_from_frame);
}

// The label of an object that is at this point of the first frame, seen in `frame`.
Label SeenAt(const GroundMotion& motion, int frame, std::int64_t id, double x, double y) {
  const Eigen::Vector3d point =
      motion.first_from_frame[frame - 1].inverse() * Eigen::Vector3d(x, y, 1);
  Label label;
  label.box.frame = frame;
  label.box.id = id;
  label.box.box = {point.x() / point.z() - 5.5, point.y() / point.z() - 3.5, 12, 8};
  return label;
}

Recording EmptyRecording() {
  Recording recording;
  recording.width = 2000;
  recording.height = 2000;
  recording.frames = kFrames;
  recording.labelling = Labelling::kObjects;
  return recording;
}

int Counting(const Recording& recording, std::int64_t id) {
  int counting = 0;
  for (const Label& label : recording.labels) {
    counting += label.box.id == id && label.box.score > 0 ? 1 : 0;
  }
  return counting;
}

TEST(MotionFilter, WhatStandsOnTheGroundDoesNotCount) {
  const GroundMotion motion = Flight(kFrames);
  Recording recording = EmptyRecording();
  for (int frame = 1; frame <= kFrames; ++frame) {
    recording.labels.push_back(SeenAt(motion, frame, 1, 900, 800));                     // parked
    recording.labels.push_back(SeenAt(motion, frame, 2, 900 + 0.4 * frame, 900));       // walks
    recording.labels.push_back(SeenAt(motion, frame, 3, 900 + 0.3 * frame, 950));       // creeps
    recording.labels.push_back(SeenAt(motion, frame, 4, 900 + frame % 2 * 3.0, 1000));  // jumps
  }
  FilterMovers(recording, motion);
  EXPECT_TRUE(recording.labels_move);
  EXPECT_EQ(Counting(recording, 1), 0);
  EXPECT_EQ(Counting(recording, 2), kFrames);
  EXPECT_EQ(Counting(recording, 3), 0);
  EXPECT_EQ(Counting(recording, 4), 0);
}

TEST(MotionFilter, AnObjectChangesSidesWhereItStops) {
  const GroundMotion motion = Flight(kFrames);
  Recording recording = EmptyRecording();
  // 2 px a frame up to frame 30, then nothing: within 30 frames around it, frame t sees 2 px for
  // each of those up to 30.
  for (int frame = 1; frame <= kFrames; ++frame) {
    recording.labels.push_back(SeenAt(motion, frame, 1, 900 + 2 * std::min(frame, 30), 800));
  }
  FilterMovers(recording, motion);
  for (const Label& label : recording.labels) {
    const int frame = label.box.frame;
    // The window of 30 frames starts 15 frames before, at the end of the track 30 before its end.
    const int start = std::max(1, std::min(frame - 15, kFrames - 30));
    const int travelled = 2 * std::max(0, 30 - start);
    // Exactly 10 px would be told by rounding.
    if (travelled == 10) continue;
    EXPECT_EQ(label.box.score > 0, travelled > 10) << frame;
  }
}

TEST(MotionFilter, ShortTracksMustTravelTheirShare) {
  const GroundMotion motion = Flight(kFrames);
  Recording recording = EmptyRecording();
  for (int frame = 1; frame <= 16; ++frame) {
    recording.labels.push_back(SeenAt(motion, frame, 1, 900 + 0.4 * frame, 800));
    recording.labels.push_back(SeenAt(motion, frame, 2, 900 + 0.3 * frame, 850));
    if (frame <= 15) recording.labels.push_back(SeenAt(motion, frame, 3, 900 + 9 * frame, 900));
  }
  recording.labels.push_back(SeenAt(motion, 1, -1, 900, 950));
  FilterMovers(recording, motion);
  EXPECT_EQ(Counting(recording, 1), 16);
  EXPECT_EQ(Counting(recording, 2), 0);
  EXPECT_EQ(Counting(recording, 3), 0);  // too brief
  EXPECT_EQ(Counting(recording, -1), 0);
  EXPECT_THAT(recording.notes,
              testing::ElementsAre(testing::HasSubstr("1 labels have no identity")));
}

TEST(MotionFilter, BoxesThatTheBorderCutsSayNothing) {
  const GroundMotion motion =
      TrueGroundMotion(std::vector<Eigen::Matrix3d>(kFrames, Eigen::Matrix3d::Identity()));
  Recording recording = EmptyRecording();
  for (int frame = 1; frame <= kFrames; ++frame) {
    // Parked at the left border, its box ever narrower up to frame 30 as if it moved.
    Label label = SeenAt(motion, frame, 1, 900, 800);
    label.box.box.x = frame <= 30 ? 0 : 20;
    if (frame <= 30) label.box.box.width = 100 - 2 * frame;
    recording.labels.push_back(label);
    // Goes the same way as it leaves.
    Label leaving = SeenAt(motion, frame, 2, 900 - 15 * frame, 900);
    if (leaving.box.box.x < 2) {
      leaving.box.box.x = 0;
      leaving.box.box.width = 3;
    }
    recording.labels.push_back(leaving);
  }
  FilterMovers(recording, motion);
  EXPECT_EQ(Counting(recording, 1), 0);
  EXPECT_EQ(Counting(recording, 2), kFrames);
}

TEST(MotionFilter, LostRegistrationIsNoMotion) {
  GroundMotion motion = Flight(kFrames);
  Recording recording = EmptyRecording();
  for (int frame = 1; frame <= kFrames; ++frame) {
    recording.labels.push_back(SeenAt(motion, frame, 1, 900, 800));
  }
  // From frame 31 on nobody knows how the picture lies over what was before.
  Eigen::Matrix3d leap = Eigen::Matrix3d::Identity();
  leap(0, 2) = 100;
  for (int frame = 31; frame <= kFrames; ++frame) {
    motion.first_from_frame[frame - 1] = leap * motion.first_from_frame[frame - 1];
  }
  Recording leapt = recording;
  FilterMovers(leapt, motion);
  EXPECT_GT(Counting(leapt, 1), 0);
  for (int frame = 31; frame <= kFrames; ++frame) motion.segment[frame - 1] = 1;
  FilterMovers(recording, motion);
  EXPECT_EQ(Counting(recording, 1), 0);
}

TEST(MotionFilter, KnownMoversStayAndTooLittleMotionIsRefused) {
  const GroundMotion motion = Flight(kFrames);
  Recording recording = EmptyRecording();
  recording.labels.push_back(SeenAt(motion, 1, 1, 900, 800));
  recording.labels_move = true;
  FilterMovers(recording, motion);
  EXPECT_EQ(Counting(recording, 1), 1);
  recording.labels_move = false;
  EXPECT_THROW(FilterMovers(recording, GroundMotion()), std::invalid_argument);
}

TEST(CameraStatistics, AreThoseOfTheMotion) {
  const int width = 641;
  const int height = 481;
  const CameraStatistics statistics = SummariseCamera(Flight(10), width, height);
  EXPECT_EQ(statistics.pairs, 9);
  EXPECT_EQ(statistics.lost, 0);
  const Eigen::Vector3d moved = PreviousFromFrame() * Eigen::Vector3d(320, 240, 1);
  const double shift = std::hypot(moved.x() / moved.z() - 320, moved.y() / moved.z() - 240);
  EXPECT_NEAR(statistics.shift_px->median, shift, 1e-9);
  EXPECT_NEAR(statistics.shift_px->largest, shift, 1e-9);
  EXPECT_NEAR(statistics.rotation_deg->median, 1, 1e-9);
  EXPECT_NEAR(statistics.scale->least, 1, 1e-9);
  EXPECT_GT(statistics.overlap->least, 0.9);
}

TEST(CameraStatistics, ThingsGrowWhereTheCameraComesNearer) {
  Eigen::Matrix3d closer = Eigen::Matrix3d::Identity();
  closer.topLeftCorner<2, 2>() *= 0.8;
  const CameraStatistics statistics =
      SummariseCamera(TrueGroundMotion({Eigen::Matrix3d::Identity(), closer}), 640, 480);
  EXPECT_NEAR(statistics.scale->median, 1.25, 1e-12);
  EXPECT_NEAR(statistics.rotation_deg->largest, 0, 1e-12);
  EXPECT_NEAR(statistics.overlap->least, 1, 1e-3);
  // Seen the other way round, only 0.8 of either side was there before; and a step of 8 of 640 px
  // leaves the rest.
  Eigen::Matrix3d step = Eigen::Matrix3d::Identity();
  step(0, 2) = 8;
  const CameraStatistics away =
      SummariseCamera(TrueGroundMotion({closer, Eigen::Matrix3d::Identity(), step}), 640, 480);
  EXPECT_NEAR(away.scale->least, 0.8, 1e-12);
  EXPECT_NEAR(away.overlap->least, 0.64, 1e-3);
  EXPECT_NEAR(away.overlap->largest, 632.0 / 640, 1e-3);
}

// The ground's picture of a pinhole camera that looks at the horizon and flies forward: above the
// horizon the same homography says nothing.
TEST(CameraStatistics, TheSkyIsLeftOut) {
  const double focal = 500;
  const double horizon = 300;  // row
  // Ground at height 1 below the camera: row = horizon + focal / depth. One step is 0.01.
  const auto forward = [&](double u, double v) {
    const double depth = focal / (v - horizon);
    const double before = depth + 0.01;
    return Eigen::Vector2d(320 + (u - 320) * depth / before, horizon + focal / before);
  };
  // previous_from_frame of that motion: rows and columns scale by depth / (depth + step).
  Eigen::Matrix3d matrix;
  const double step = 0.01 / focal;
  matrix << 1, 320 * step, -320 * step * horizon, 0, 1 + horizon * step, -horizon * step * horizon,
      0, step, 1 - step * horizon;
  const Eigen::Vector3d checked = matrix * Eigen::Vector3d(100, 450, 1);
  EXPECT_NEAR(checked.x() / checked.z(), forward(100, 450).x(), 1e-9);
  EXPECT_NEAR(checked.y() / checked.z(), forward(100, 450).y(), 1e-9);
  const std::vector<Eigen::Vector3d> horizons(2, Eigen::Vector3d(0, 1, -horizon));
  const CameraStatistics statistics =
      SummariseCamera(TrueGroundMotion({Eigen::Matrix3d::Identity(), matrix}), 641, 481, horizons);
  // Grid rows of 30 px: those at 315 to 465 px and more lie below the horizon; their mean is 390.
  const Eigen::Vector2d middle(320, 390);
  EXPECT_NEAR(statistics.shift_px->median, (forward(320, 390) - middle).norm(), 0.02);
}

TEST(GroundMotion, SegmentsFollowTheRegistration) {
  std::vector<FrameRegistration> registrations(4);
  registrations[0].starts_segment = true;
  registrations[1].previous_from_frame(0, 2) = 5;
  registrations[2].starts_segment = true;
  registrations[2].quality = RegistrationQuality::kLost;
  registrations[3].previous_from_frame(0, 2) = 7;
  const GroundMotion motion = MeasuredGroundMotion(registrations);
  EXPECT_THAT(motion.segment, testing::ElementsAre(0, 0, 1, 1));
  const CameraStatistics statistics = SummariseCamera(motion, 640, 480);
  EXPECT_EQ(statistics.pairs, 2);
  EXPECT_EQ(statistics.lost, 1);
  EXPECT_NEAR(statistics.shift_px->least, 5, 1e-9);
  EXPECT_NEAR(statistics.shift_px->median, 6, 1e-9);
  EXPECT_NEAR(statistics.shift_px->largest, 7, 1e-9);
  EXPECT_FALSE(SummariseCamera(GroundMotion(), 640, 480).shift_px);
}

}  // namespace
}  // namespace windhover::replay
