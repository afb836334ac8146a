// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/trails.h"

#include <gtest/gtest.h>

#include "service/vision/homography.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

FrameRegistration Step(const Eigen::Matrix3d& previous_from_frame) {
  FrameRegistration registration;
  registration.previous_from_frame = previous_from_frame;
  return registration;
}

std::vector<Detection> ObjectAt(std::uint64_t id, const Eigen::Vector2d& centre) {
  Detection detection;
  detection.track_id = id;
  detection.box = {centre.x() - 2.0, centre.y() - 2.0, 5.0, 5.0};
  return {detection};
}

// An object that stands still on the ground has a trail of one place, however the camera moves.
TEST(Trails, StayOnTheGround) {
  Trails trails(10);
  const Eigen::Vector2d on_ground(100.0, 80.0);
  Eigen::Matrix3d before = CameraMotion(320, 240, 0.0, 1.0, 0.0, 0.0);
  for (int t = 0; t < 20; ++t) {
    const Eigen::Matrix3d ground_from_frame =
        CameraMotion(320, 240, 0.02 * t, 1.0 + 0.01 * t, 2.0 * t, -t);
    const Eigen::Vector2d in_frame = Project(InverseHomography(ground_from_frame), on_ground);
    trails.Advance(Step(InverseHomography(before) * ground_from_frame), ObjectAt(1, in_frame));
    before = ground_from_frame;
    ASSERT_EQ(trails.trails().size(), 1u);
    const Trails::Trail& trail = trails.trails()[0];
    EXPECT_EQ(trail.points.size(), static_cast<std::size_t>(std::min(t + 1, 10)));
    for (const Eigen::Vector2d& point : trail.points) EXPECT_LT((point - in_frame).norm(), 1e-6);
  }
}

TEST(Trails, ShrinkAndEndWhenTheTrackIsGone) {
  Trails trails(4);
  const FrameRegistration still = Step(Eigen::Matrix3d::Identity());
  for (int t = 0; t < 4; ++t) trails.Advance(still, ObjectAt(1, {10.0 + t, 10.0}));
  for (std::size_t left = 3; left > 0; --left) {
    trails.Advance(still, {});
    ASSERT_EQ(trails.trails().size(), 1u);
    EXPECT_EQ(trails.trails()[0].points.size(), left);
    EXPECT_FALSE(trails.trails()[0].seen);
  }
  trails.Advance(still, {});
  EXPECT_TRUE(trails.trails().empty());
  trails.Advance(still, ObjectAt(2, {50.0, 50.0}));
  ASSERT_EQ(trails.trails().size(), 1u);
  EXPECT_EQ(trails.trails()[0].track_id, 2u);
  EXPECT_EQ(trails.trails()[0].points.size(), 1u);
}

TEST(Trails, EndWhereTheGroundIsKnownAnew) {
  const FrameRegistration still = Step(Eigen::Matrix3d::Identity());
  for (const bool lost : {false, true}) {
    FrameRegistration anew = still;
    anew.starts_segment = !lost;
    anew.quality = lost ? RegistrationQuality::kLost : RegistrationQuality::kValid;
    Trails trails(8);
    const auto three_points = [&] {
      for (int t = 0; t < 3; ++t) trails.Advance(still, ObjectAt(1, {10.0 + t, 10.0}));
      return trails.trails().size() == 1 && trails.trails()[0].points.size() == 3;
    };
    ASSERT_TRUE(three_points());
    trails.Advance(anew, {});
    EXPECT_TRUE(trails.trails().empty());
    ASSERT_TRUE(three_points());
    trails.Advance(anew, ObjectAt(1, {13.0, 10.0}));
    ASSERT_EQ(trails.trails().size(), 1u);
    EXPECT_EQ(trails.trails()[0].points.size(), 1u) << "of the new ground";
  }
}

}  // namespace
}  // namespace windhover
