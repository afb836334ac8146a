// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "service/vision/forward_backward.h"
#include "tests/service/motion_scene.h"

namespace windhover {
namespace {

constexpr int kSize = 120;
const Eigen::Vector2f kMiddle(60, 60);

ForwardBackwardFilter::Trace Follow(const MotionScene& scene, const Eigen::Vector2f& seed,
                                    const Eigen::Vector2f& velocity_px, int cell_px = 1,
                                    double margin_px = 2.0) {
  const MotionEvidence evidence = scene.Evidence();
  const MappedScene mapped(evidence);
  ForwardBackwardFilter filter(margin_px);
  filter.SetWindow(mapped.window, mapped.centre);
  return filter.Follow(seed, velocity_px, cell_px);
}

TEST(ForwardBackwardFilter, FollowsWhatMoves) {
  MotionScene scene(kSize, kSize, MotionScene::Offsets(-5, 5));
  scene.AddMover(54, 55, 13, 11, 2.0, -1.0, 200);
  const auto trace = Follow(scene, kMiddle, {1.6F, -0.7F});
  EXPECT_TRUE(trace.kept);
  EXPECT_EQ(trace.directions, 2);
  EXPECT_LT(trace.error_px, 0.2);
  EXPECT_NEAR(trace.velocity_px.x(), 2.0, 0.05);
  EXPECT_NEAR(trace.velocity_px.y(), -1.0, 0.05);
}

TEST(ForwardBackwardFilter, FollowsLargeThingsInLargeCells) {
  MotionScene scene(kSize, kSize, MotionScene::Offsets(-5, 5));
  scene.AddMover(40, 40, 40, 40, 3.0, 1.0, 180);
  const auto trace = Follow(scene, kMiddle, {1.8F, 1.5F}, 2);
  EXPECT_TRUE(trace.kept);
  EXPECT_NEAR(trace.velocity_px.x(), 3.0, 0.1);
  EXPECT_NEAR(trace.velocity_px.y(), 1.0, 0.1);
}

// Each frame shows something else at the same place: light on water, leaves.
TEST(ForwardBackwardFilter, DropsWhatFlickers) {
  int kept = 0;
  constexpr int kTrials = 60;
  for (int trial = 0; trial < kTrials; ++trial) {
    MotionScene scene(kSize, kSize, MotionScene::Offsets(-5, 5), 100 + trial);
    for (int offset = -5; offset <= 5; ++offset) {
      scene.AddMover(50, 50, 21, 21, 0, 0, 200, [&](int o) { return o == offset; });
    }
    if (Follow(scene, kMiddle, {1.0F, 0.0F}).kept) ++kept;
  }
  EXPECT_LT(kept, kTrials / 4);
}

TEST(ForwardBackwardFilter, TheMarginDecides) {
  MotionScene scene(kSize, kSize, MotionScene::Offsets(-5, 5));
  scene.AddMover(54, 55, 13, 11, 2.0, -1.0, 200);
  EXPECT_TRUE(Follow(scene, kMiddle, {1.6F, -0.7F}, 1, 0.5).kept);
  EXPECT_FALSE(Follow(scene, kMiddle, {1.6F, -0.7F}, 1, 1e-6).kept);
}

TEST(ForwardBackwardFilter, OneDirectionIsEnough) {
  MotionScene scene(kSize, kSize, MotionScene::Offsets(-5, 5));
  scene.AddMover(54, 55, 13, 11, 2.0, 0.0, 200, [](int offset) { return offset >= 0; });
  const auto trace = Follow(scene, kMiddle, {2.0F, 0.0F});
  EXPECT_TRUE(trace.kept);
  EXPECT_NEAR(trace.velocity_px.x(), 2.0, 0.1);
}

TEST(ForwardBackwardFilter, BrightnessDoesNotMatter) {
  MotionScene scene(kSize, kSize, MotionScene::Offsets(-5, 5));
  scene.AddMover(54, 55, 13, 11, 2.0, -1.0, 150);
  for (int f = 0; f < scene.frames(); ++f) {
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) scene.Set(f, x, y, scene.Get(f, x, y) + 3 * f);
    }
  }
  const auto trace = Follow(scene, kMiddle, {1.7F, -0.8F});
  EXPECT_TRUE(trace.kept);
  EXPECT_NEAR(trace.velocity_px.x(), 2.0, 0.1);
}

TEST(ForwardBackwardFilter, TellsTextureFromFlatness) {
  MotionScene scene(kSize, kSize, MotionScene::Offsets(-1, 1));
  scene.AddMover(50, 50, 21, 21, 0, 0, 200);
  for (int y = 10; y < 40; ++y) {
    for (int x = 10; x < 40; ++x) scene.Set(1, x, y, 200);
  }
  const MotionEvidence evidence = scene.Evidence();
  const MappedScene mapped(evidence);
  ForwardBackwardFilter filter(2.0);
  filter.SetWindow(mapped.window, mapped.centre);
  EXPECT_GT(filter.Texture(kMiddle, 1), ForwardBackwardFilter::kMinTexture);
  EXPECT_LT(filter.Texture({25, 25}, 1), ForwardBackwardFilter::kMinTexture);
}

TEST(ForwardBackwardFilter, SaysNothingWithoutGroundOrFrames) {
  MotionScene alone(kSize, kSize, {0});
  alone.AddMover(54, 55, 13, 11, 0, 0, 200);
  EXPECT_EQ(Follow(alone, kMiddle, {0, 0}).directions, 0);
  EXPECT_TRUE(Follow(alone, kMiddle, {0, 0}).kept);

  MotionScene hidden(kSize, kSize, MotionScene::Offsets(-5, 5));
  hidden.AddMover(54, 55, 13, 11, 0, 0, 200);
  for (int f = 0; f < hidden.frames(); ++f) {
    if (hidden.offset(f) != 0) hidden.Hide(f, 0, 0, kSize, kSize);
  }
  EXPECT_EQ(Follow(hidden, kMiddle, {0, 0}).directions, 0);

  // One unseen column or row next to the pattern's last is enough where samples lie between pixels.
  for (const bool column : {true, false}) {
    for (const int cell_px : {1, 2}) {
      MotionScene partly(kSize, kSize, MotionScene::Offsets(-5, 5));
      partly.AddMover(40, 40, 41, 41, 0, 0, 200);
      const int reach = (11 * cell_px + 1) / 2;  // only interpolation looks there
      for (int f = 0; f < partly.frames(); ++f) {
        if (partly.offset(f) == 0) continue;
        partly.Hide(f, column ? 60 + reach : 0, column ? 0 : 60 + reach, column ? 1 : kSize,
                    column ? kSize : 1);
      }
      const Eigen::Vector2f off(column ? 0.5F : 0.0F, column ? 0.0F : 0.5F);
      const Eigen::Vector2f seed = kMiddle + (cell_px == 1 ? off : Eigen::Vector2f(0, 0));
      EXPECT_EQ(Follow(partly, seed, {0, 0}, cell_px).directions, 0) << column << cell_px;
    }
  }

  MotionScene tiny(1, 1, MotionScene::Offsets(-1, 1));
  EXPECT_TRUE(Follow(tiny, {0, 0}, {0, 0}).kept);
  EXPECT_TRUE(Follow(tiny, {0, 0}, {0, 0}, 4).kept);
}

}  // namespace
}  // namespace windhover
