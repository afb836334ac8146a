// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "service/vision/voting.h"
#include "tests/service/motion_scene.h"

namespace windhover {
namespace {

constexpr int kWidth = 200;
constexpr int kHeight = 160;

struct Outcome {
  BitPlane kept;
  int seeds = 0;  // before the filter
};

Outcome Vote(const MotionScene& scene, VotingFilter& filter) {
  const MotionEvidence evidence = scene.Evidence();
  const MappedScene mapped(evidence);
  Outcome outcome;
  filter.Run(mapped.window, mapped.centre, outcome.kept);
  const BitView& seeds = mapped.window[mapped.centre].seeds;
  outcome.seeds = CountBits(seeds, 0, 0, seeds.width, seeds.height);
  return outcome;
}

int Count(const BitPlane& plane, int x, int y, int width, int height) {
  return CountBits(plane.View(), x, y, width, height);
}

TEST(VotingFilter, KeepsWhatMovesAtConstantVelocity) {
  for (const double max_speed : {2.5, 8.0}) {
    MotionScene scene(kWidth, kHeight, MotionScene::Offsets(-10, 10));
    scene.AddMover(100, 80, 5, 5, 2.0, -1.0, 220);
    VotingFilter filter(max_speed, 0.5);
    const Outcome outcome = Vote(scene, filter);
    EXPECT_GE(outcome.seeds, 20);
    EXPECT_EQ(Count(outcome.kept, 100, 80, 5, 5), outcome.seeds);
    EXPECT_NEAR(filter.At(102, 82).velocity_px.x(), 2.0, 0.3);
    EXPECT_NEAR(filter.At(102, 82).velocity_px.y(), -1.0, 0.3);
    EXPECT_GT(filter.At(102, 82).share, 0.95);
  }
}

TEST(VotingFilter, DropsSpecksThatComeAndGo) {
  MotionScene scene(kWidth, kHeight, MotionScene::Offsets(-10, 10));
  scene.AddSpecks(30, 2, 250);
  VotingFilter filter(2.5, 0.5);
  const Outcome outcome = Vote(scene, filter);
  EXPECT_GT(outcome.seeds, 80);
  EXPECT_LT(Count(outcome.kept, 0, 0, kWidth, kHeight), outcome.seeds / 10);
}

TEST(VotingFilter, KeepsTheMoverAndDropsTheSpecksAroundIt) {
  MotionScene scene(kWidth, kHeight, MotionScene::Offsets(-10, 10));
  scene.AddSpecks(30, 2, 250);
  scene.AddMover(64, 90, 6, 4, -1.5, 1.0, 220);
  VotingFilter filter(2.5, 0.5);
  const Outcome outcome = Vote(scene, filter);
  const int mover = Count(outcome.kept, 64, 90, 6, 4);
  EXPECT_GE(mover, 20);
  EXPECT_LT(Count(outcome.kept, 0, 0, kWidth, kHeight) - mover, 20);
}

// The place that a parked car has left: seeds at rest, in less than half of the frames.
TEST(VotingFilter, DropsTheGhostOfWhatHasLeft) {
  MotionScene scene(kWidth, kHeight, MotionScene::Offsets(-20, 0));
  scene.AddMover(100, 80, 12, 8, 0, 0, 220, [](int offset) { return offset > -9; });
  VotingFilter filter(2.5, 0.5);
  const Outcome outcome = Vote(scene, filter);
  EXPECT_GT(outcome.seeds, 80);
  EXPECT_EQ(Count(outcome.kept, 0, 0, kWidth, kHeight), 0);
}

TEST(VotingFilter, DropsWhatIsFasterThanTheLimit) {
  MotionScene scene(400, kHeight, MotionScene::Offsets(-10, 10));
  scene.AddMover(200, 80, 4, 4, 7.0, 0.0, 220);
  VotingFilter slow(2.5, 0.5);
  EXPECT_EQ(Count(Vote(scene, slow).kept, 0, 0, 400, kHeight), 0);
  VotingFilter fast(8.0, 0.5);
  EXPECT_GE(Count(Vote(scene, fast).kept, 200, 80, 4, 4), 14);
}

TEST(VotingFilter, TellsCrossingTrajectoriesApart) {
  MotionScene scene(kWidth, kHeight, MotionScene::Offsets(-10, 10));
  scene.AddMover(80, 80, 5, 5, 2.0, 0.0, 220);
  scene.AddMover(100, 64, 5, 5, 0.0, 2.0, 220);
  VotingFilter filter(2.5, 0.5);
  Vote(scene, filter);
  EXPECT_NEAR(filter.At(82, 82).velocity_px.x(), 2.0, 0.4);
  EXPECT_NEAR(filter.At(82, 82).velocity_px.y(), 0.0, 0.4);
  EXPECT_NEAR(filter.At(102, 66).velocity_px.x(), 0.0, 0.4);
  EXPECT_NEAR(filter.At(102, 66).velocity_px.y(), 2.0, 0.4);
}

TEST(VotingFilter, WorksWithoutFutureFrames) {
  MotionScene scene(kWidth, kHeight, MotionScene::Offsets(-10, 0));
  scene.AddSpecks(30, 2, 250);
  scene.AddMover(100, 80, 6, 4, 2.0, -1.0, 220);
  VotingFilter filter(2.5, 0.5);
  const Outcome outcome = Vote(scene, filter);
  const int mover = Count(outcome.kept, 100, 80, 6, 4);
  EXPECT_GE(mover, 20);
  EXPECT_LT(Count(outcome.kept, 0, 0, kWidth, kHeight) - mover, outcome.seeds / 4);
}

TEST(VotingFilter, WorksWithFramesMissing) {
  MotionScene scene(kWidth, kHeight, {-10, -9, -7, -3, 0, 1, 2, 6, 8, 9});
  scene.AddMover(100, 80, 5, 5, 2.0, 1.0, 220);
  VotingFilter filter(2.5, 0.5);
  EXPECT_GE(Count(Vote(scene, filter).kept, 100, 80, 5, 5), 20);
  EXPECT_NEAR(filter.At(102, 82).velocity_px.x(), 2.0, 0.3);
}

// The share is one of the frames that have seen the trajectory's ground.
TEST(VotingFilter, KeepsWhatComesIntoThePicture) {
  MotionScene scene(kWidth, kHeight, MotionScene::Offsets(-10, 10));
  scene.AddMover(2, 80, 6, 6, 2.0, 0.0, 220);
  VotingFilter filter(2.5, 0.8);
  EXPECT_GE(Count(Vote(scene, filter).kept, 2, 80, 6, 6), 30);

  MotionScene hidden(kWidth, kHeight, MotionScene::Offsets(-10, 10));
  hidden.AddMover(100, 80, 6, 6, 2.0, 0.0, 220);
  for (int f = 0; f < hidden.frames(); ++f) hidden.Hide(f, 0, 0, 98, kHeight);
  EXPECT_GE(Count(Vote(hidden, filter).kept, 100, 80, 6, 6), 30);
}

TEST(VotingFilter, AShareOfOneAsksForAllFrames) {
  MotionScene scene(kWidth, kHeight, MotionScene::Offsets(-10, 10));
  scene.AddMover(100, 80, 3, 3, 2.0, 0.0, 220, [](int offset) { return offset != 9; });
  VotingFilter strict(2.5, 1.0);
  EXPECT_EQ(Count(Vote(scene, strict).kept, 0, 0, kWidth, kHeight), 0);
  VotingFilter lenient(2.5, 0.9);
  EXPECT_GE(Count(Vote(scene, lenient).kept, 100, 80, 3, 3), 7);
}

TEST(VotingFilter, Degenerate) {
  VotingFilter filter(2.5, 0.5);
  BitPlane kept;

  const MotionEvidence empty = MotionScene(70, 50, MotionScene::Offsets(-10, 10)).Evidence();
  const MappedScene no_seeds(empty);
  filter.Run(no_seeds.window, no_seeds.centre, kept);
  EXPECT_EQ(kept.width(), 70);
  EXPECT_EQ(kept.height(), 50);
  EXPECT_EQ(Count(kept, 0, 0, 70, 50), 0);
  EXPECT_EQ(filter.At(69, 49).share, 0.0F);

  // Seeds everywhere agree with any trajectory.
  MotionScene flooded(300, 250, MotionScene::Offsets(-10, 10));
  flooded.AddMover(0, 0, 300, 250, 0, 0, 250);
  const MotionEvidence flood = flooded.Evidence();
  const MappedScene all_seeds(flood);
  filter.Run(all_seeds.window, all_seeds.centre, kept);
  const BitView& seeds = all_seeds.window[all_seeds.centre].seeds;
  EXPECT_EQ(Count(kept, 0, 0, 300, 250), CountBits(seeds, 0, 0, 300, 250));

  // Nobody votes.
  MotionScene lonely(70, 50, {0});
  lonely.AddMover(20, 20, 9, 9, 0, 0, 250);
  EXPECT_EQ(Count(Vote(lonely, filter).kept, 0, 0, 70, 50), 0);

  MotionScene tiny(1, 1, MotionScene::Offsets(-2, 2));
  tiny.AddMover(0, 0, 1, 1, 0, 0, 250);
  EXPECT_EQ(Count(Vote(tiny, filter).kept, 0, 0, 1, 1), 1);
}

}  // namespace
}  // namespace windhover
