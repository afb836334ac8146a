// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "service/vision/motion_fragments.h"
#include "tests/service/motion_scene.h"

namespace windhover {
namespace {

MotionFragment Fragment(int left, int top, int width, int height, float vx, float vy) {
  return {left, top, left + width - 1, top + height - 1, {vx, vy}, 0};
}

bool Joined(const MotionScene& scene, std::vector<MotionFragment> fragments) {
  const MotionEvidence evidence = scene.Evidence();
  const MappedScene mapped(evidence);
  JoinFragments({mapped.window, mapped.centre, mapped.background}, fragments);
  return fragments[1].object == fragments[0].object;
}

MotionScene Scene() { return {160, 120, MotionScene::Offsets(-10, 10)}; }

// A long dark vehicle, of which only the ends stand out of the ground.
TEST(JoinFragments, JoinsTheEndsOfOneObject) {
  MotionScene scene = Scene();
  scene.AddMover(60, 50, 30, 10, 2.0, 0.0, 100);
  EXPECT_TRUE(
      Joined(scene, {Fragment(60, 50, 10, 10, 2.0, 0.0), Fragment(78, 50, 12, 10, 2.0, 0.0)}));
}

TEST(JoinFragments, LeavesTwoCarsInARowApart) {
  MotionScene scene = Scene();
  scene.AddMover(50, 50, 16, 8, 2.0, 0.0, 200);
  scene.AddMover(76, 50, 16, 8, 2.0, 0.0, 200);
  EXPECT_FALSE(
      Joined(scene, {Fragment(50, 50, 16, 8, 2.0, 0.0), Fragment(76, 50, 16, 8, 2.0, 0.0)}));
}

TEST(JoinFragments, LeavesNeighboursInOtherLanesApart) {
  MotionScene scene = Scene();
  scene.AddMover(60, 50, 20, 24, 2.0, 0.0, 100);  // even if all between them moved
  EXPECT_FALSE(
      Joined(scene, {Fragment(60, 50, 20, 8, 2.0, 0.0), Fragment(60, 66, 20, 8, 2.0, 0.0)}));
}

TEST(JoinFragments, LeavesApartWhatMovesDifferently) {
  MotionScene scene = Scene();
  scene.AddMover(60, 50, 30, 10, 2.0, 0.0, 100);
  EXPECT_FALSE(
      Joined(scene, {Fragment(60, 50, 10, 10, 2.0, 0.0), Fragment(78, 50, 12, 10, -2.0, 0.0)}));
  EXPECT_FALSE(
      Joined(scene, {Fragment(60, 50, 10, 10, 2.0, 0.0), Fragment(78, 50, 12, 10, 1.3, 0.0)}));
}

TEST(JoinFragments, LeavesApartWhatIsFarApart) {
  MotionScene scene = Scene();
  scene.AddMover(30, 50, 60, 10, 2.0, 0.0, 100);
  EXPECT_FALSE(
      Joined(scene, {Fragment(30, 50, 8, 10, 2.0, 0.0), Fragment(82, 50, 8, 10, 2.0, 0.0)}));
}

TEST(JoinFragments, JoinsChains) {
  MotionScene scene = Scene();
  scene.AddMover(30, 50, 60, 10, 2.0, 0.0, 100);
  std::vector<MotionFragment> fragments = {
      Fragment(78, 50, 12, 10, 2.0, 0.0), Fragment(30, 50, 12, 10, 2.0, 0.0),
      Fragment(54, 50, 14, 10, 2.0, 0.0), Fragment(10, 100, 5, 5, 0.0, 1.0)};
  const MotionEvidence evidence = scene.Evidence();
  const MappedScene mapped(evidence);
  JoinFragments({mapped.window, mapped.centre, mapped.background}, fragments);
  EXPECT_EQ(fragments[0].object, 0);
  EXPECT_EQ(fragments[1].object, 0);
  EXPECT_EQ(fragments[2].object, 0);
  EXPECT_EQ(fragments[3].object, 3);
}

TEST(JoinFragments, Degenerate) {
  // Nothing can be told on one pixel.
  const MotionEvidence evidence = MotionScene(1, 1, {0}).Evidence();
  const MappedScene mapped(evidence);
  std::vector<MotionFragment> none;
  JoinFragments({mapped.window, mapped.centre, mapped.background}, none);
  std::vector<MotionFragment> one = {Fragment(0, 0, 1, 1, 1.0, 0.0)};
  JoinFragments({mapped.window, mapped.centre, mapped.background}, one);
  EXPECT_EQ(one[0].object, 0);
}

// Without voting and forward-backward filter nobody knows a velocity.
TEST(JoinFragments, LeavesApartWhatDoesNotMove) {
  MotionScene scene = Scene();
  scene.AddMover(60, 50, 30, 10, 2.0, 0.0, 100);
  EXPECT_FALSE(
      Joined(scene, {Fragment(60, 50, 10, 10, 0.0, 0.0), Fragment(78, 50, 12, 10, 0.0, 0.0)}));
}

}  // namespace
}  // namespace windhover
