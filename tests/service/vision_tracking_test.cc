// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <set>

#include "service/vision/tracking.h"

namespace windhover {
namespace {

constexpr TrackingSettings kSettings = {
    .max_speed_px = 4.0, .min_travel_px = 3.0, .min_track_frames = 4, .max_coast_frames = 5};

FrameRegistration Registration(int frame, const Eigen::Matrix3d& previous_from_frame) {
  FrameRegistration registration;
  registration.frame_number = static_cast<std::uint64_t>(frame);
  registration.previous_from_frame = previous_from_frame;
  registration.starts_segment = frame == 0;
  return registration;
}

FrameRegistration Still(int frame) { return Registration(frame, Eigen::Matrix3d::Identity()); }

MotionCandidate Candidate(const Eigen::Vector2d& centre, double width = 12, double height = 7) {
  MotionCandidate candidate;
  candidate.box = {centre.x() - (width - 1) / 2, centre.y() - (height - 1) / 2, width, height};
  candidate.confidence = 1.0;
  return candidate;
}

TEST(Tracking, KeepsTheIdThroughAnOcclusion) {
  Tracking tracking(kSettings);
  std::set<std::uint64_t> ids;
  int reported = 0;
  for (int frame = 0; frame < 40; ++frame) {
    std::vector<MotionCandidate> candidates;
    const bool hidden = frame >= 20 && frame < 23;
    if (!hidden) candidates.push_back(Candidate({50 + 2.0 * frame, 80 - 1.0 * frame}));
    for (const Detection& detection : tracking.Update(Still(frame), candidates)) {
      ids.insert(detection.track_id);
      ++reported;
    }
  }
  EXPECT_EQ(ids.size(), 1U);
  EXPECT_EQ(reported, 40 - 3 - 3);
}

// The camera turns about the picture's middle and shifts: the same as above, over the ground.
TEST(Tracking, FollowsOverTheGroundUnderAMovingCamera) {
  Tracking tracking(kSettings);
  Eigen::Matrix3d previous_from_frame = Eigen::Matrix3d::Identity();
  previous_from_frame.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(0.03).toRotationMatrix();
  previous_from_frame.topRightCorner<2, 1>() = Eigen::Vector2d(6, -9);
  Eigen::Matrix3d frame_from_ground = Eigen::Matrix3d::Identity();
  std::set<std::uint64_t> ids;
  for (int frame = 0; frame < 40; ++frame) {
    if (frame > 0) frame_from_ground = previous_from_frame.inverse() * frame_from_ground;
    const Eigen::Vector2d velocity(1.5, 0.5);
    const Eigen::Vector2d on_ground = Eigen::Vector2d(150, 120) + frame * velocity;
    std::vector<MotionCandidate> candidates;
    if (frame < 20 || frame >= 23) {
      candidates.push_back(Candidate((frame_from_ground * on_ground.homogeneous()).head<2>()));
    }
    const auto& detections = tracking.Update(Registration(frame, previous_from_frame), candidates);
    for (const Detection& detection : detections) {
      ids.insert(detection.track_id);
      if (frame > 30) {
        const Eigen::Vector2d truth = frame_from_ground.topLeftCorner<2, 2>() * velocity;
        EXPECT_LT((detection.velocity_px - truth).norm(), 0.3);
      }
    }
  }
  EXPECT_EQ(ids.size(), 1U);
}

TEST(Tracking, JitterAndCameraMotionAreNoTravel) {
  Tracking tracking(kSettings);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-1.0, 1.0);
  Eigen::Matrix3d previous_from_frame = Eigen::Matrix3d::Identity();
  previous_from_frame(0, 2) = 2.0;
  for (int frame = 0; frame < 300; ++frame) {
    const Eigen::Vector2d at(700 - 2.0 * frame + jitter(random), 80 + jitter(random));
    EXPECT_TRUE(tracking.Update(Registration(frame, previous_from_frame), {Candidate(at)}).empty())
        << frame;
  }
}

TEST(Tracking, ReportsOnceSeenOftenEnoughAndFarEnough) {
  Tracking by_frames(kSettings);
  int first = -1;
  for (int frame = 0; frame < 20 && first < 0; ++frame) {
    if (!by_frames.Update(Still(frame), {Candidate({50 + 3.0 * frame, 80})}).empty()) first = frame;
  }
  EXPECT_EQ(first, 3);

  TrackingSettings far = kSettings;
  far.min_travel_px = 12.0;
  Tracking by_travel(far);
  first = -1;
  for (int frame = 0; frame < 20 && first < 0; ++frame) {
    if (!by_travel.Update(Still(frame), {Candidate({50 + 1.0 * frame, 80})}).empty()) first = frame;
  }
  EXPECT_GE(first, 12);
  EXPECT_LE(first, 14);
}

TEST(Tracking, NoTravelAndOneFrameReportAtOnce) {
  Tracking tracking({.max_speed_px = 4.0});
  EXPECT_EQ(tracking.Update(Still(0), {Candidate({50, 80})}).size(), 1U);
}

TEST(Tracking, ParallelObjectsKeepTheirIds) {
  Tracking tracking(kSettings);
  std::uint64_t upper = 0;
  std::uint64_t lower = 0;
  for (int frame = 0; frame < 30; ++frame) {
    const std::vector<MotionCandidate> candidates = {Candidate({50 + 2.0 * frame, 80}),
                                                     Candidate({120 - 2.0 * frame, 92})};
    const auto& detections = tracking.Update(Still(frame), candidates);
    if (frame < 5) continue;
    ASSERT_EQ(detections.size(), 2U);
    for (const Detection& detection : detections) {
      std::uint64_t& id = detection.box.y < 84 ? upper : lower;
      if (id == 0) id = detection.track_id;
      EXPECT_EQ(detection.track_id, id);
    }
  }
  EXPECT_NE(upper, lower);
}

TEST(Tracking, EndsAfterTheLongestCoast) {
  for (const int gap : {5, 6}) {
    Tracking tracking(kSettings);
    std::set<std::uint64_t> ids;
    for (int frame = 0; frame < 40; ++frame) {
      std::vector<MotionCandidate> candidates;
      if (frame < 15 || frame >= 15 + gap) candidates.push_back(Candidate({50 + 2.0 * frame, 80}));
      for (const Detection& detection : tracking.Update(Still(frame), candidates)) {
        ids.insert(detection.track_id);
      }
    }
    EXPECT_EQ(ids.size(), gap <= 5 ? 1U : 2U);
  }
}

TEST(Tracking, IdsAreNeverUsedAgain) {
  Tracking tracking(kSettings);
  std::set<std::uint64_t> ids;
  const auto run = [&](const FrameRegistration& first) {
    std::set<std::uint64_t> here;
    for (int frame = 0; frame < 10; ++frame) {
      FrameRegistration registration = frame == 0 ? first : Still(frame);
      const auto& detections = tracking.Update(registration, {Candidate({50 + 2.0 * frame, 80})});
      if (frame == 0) {
        EXPECT_TRUE(detections.empty());
      }
      for (const Detection& detection : detections) here.insert(detection.track_id);
    }
    EXPECT_EQ(here.size(), 1U);
    for (const std::uint64_t id : here) EXPECT_TRUE(ids.insert(id).second);
  };
  run(Still(0));
  FrameRegistration cut = Still(10);
  cut.starts_segment = true;
  run(cut);
  FrameRegistration lost = Still(20);
  lost.quality = RegistrationQuality::kLost;
  run(lost);
  tracking.Reset();
  run(Still(30));
  EXPECT_EQ(*ids.begin(), 1U);
}

TEST(Tracking, ScoresGrowWithTheEvidence) {
  Tracking tracking(kSettings);
  double before = 0.0;
  for (int frame = 0; frame < 30; ++frame) {
    for (const Detection& detection :
         tracking.Update(Still(frame), {Candidate({50 + 2.0 * frame, 80})})) {
      EXPECT_GT(detection.score, before);
      EXPECT_LE(detection.score, 1.0);
      EXPECT_EQ(detection.age_frames, frame + 1);
      before = detection.score;
    }
  }
  EXPECT_GT(before, 0.9);
}

}  // namespace
}  // namespace windhover
