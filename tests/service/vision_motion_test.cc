// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>

#include "service/vision/motion.h"
#include "tests/service/motion_scene.h"

namespace windhover {
namespace {

constexpr int kWidth = 240;
constexpr int kHeight = 180;

double Overlap(const Box& a, const Box& b) {
  const double width = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const double height = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  if (width <= 0 || height <= 0) return 0.0;
  const double both = width * height;
  return both / (a.width * a.height + b.width * b.height - both);
}

struct Mover {
  double x, y;  // in frame 0
  int width, height;
  double vx, vy;

  Box At(int frame) const {
    return {std::round(x + vx * frame), std::round(y + vy * frame), static_cast<double>(width),
            static_cast<double>(height)};
  }
};

const std::vector<Mover> kMovers = {
    {40, 40, 12, 7, 2.0, 0.5}, {180, 60, 7, 12, -0.5, 1.5}, {60, 130, 12, 8, 1.5, -1.0}};

struct Clutter {
  int specks = 0;
  bool flicker = false;
};

// What the window around `frame` shows: the camera stands still.
MotionEvidence EvidenceAt(int frame, const std::vector<Mover>& movers, const Clutter& clutter = {},
                          const std::function<bool(int)>& visible = {}) {
  MotionScene scene(kWidth, kHeight, MotionScene::Offsets(-10, 10));
  for (std::size_t i = 0; i < movers.size(); ++i) {
    const Mover& mover = movers[i];
    scene.random().seed(50 + static_cast<unsigned>(i));
    scene.AddMover(mover.x + mover.vx * frame, mover.y + mover.vy * frame, mover.width,
                   mover.height, mover.vx, mover.vy, 200,
                   [&](int offset) { return !visible || visible(frame + offset); });
  }
  scene.random().seed(1000 + static_cast<unsigned>(frame));
  if (clutter.flicker) {
    // A bush: its pixels differ from the background in two of five frames, each time otherwise.
    for (int f = 0; f < scene.frames(); ++f) {
      for (int y = 140; y < 165; ++y) {
        for (int x = 190; x < 220; ++x) {
          if (scene.random()() % 5 < 2) scene.Set(f, x, y, 1 + scene.random()() % 255);
        }
      }
    }
  }
  scene.AddSpecks(clutter.specks, 3, 250);
  MotionEvidence evidence = scene.Evidence();
  evidence.registration.frame_number = static_cast<std::uint64_t>(frame);
  evidence.registration.starts_segment = frame == 0;
  return evidence;
}

struct Tally {
  int hits = 0;
  int misses = 0;
  int false_alarms = 0;
};

Tally Count(const MotionOptions& options, const std::vector<Mover>& movers,
            const Clutter& clutter) {
  MotionDetection detection(options);
  Tally tally;
  for (int frame = 0; frame < 16; ++frame) {
    const auto& detections = detection.Detect(EvidenceAt(frame, movers, clutter));
    int hits = 0;
    for (const Mover& mover : movers) {
      for (const Detection& found : detections) {
        if (Overlap(found.box, mover.At(frame)) > 0.5) {
          ++hits;
          break;
        }
      }
    }
    tally.hits += hits;
    tally.misses += static_cast<int>(movers.size()) - hits;
    tally.false_alarms += static_cast<int>(detections.size()) - hits;
  }
  return tally;
}

TEST(MotionDetection, FindsWhatMoves) {
  const MotionOptions options;
  const Tally tally = Count(options, kMovers, {});
  EXPECT_LE(tally.misses, 3 * options.min_track_frames);
  EXPECT_GE(tally.hits, 3 * (16 - options.min_track_frames));
  EXPECT_EQ(tally.false_alarms, 0);
}

TEST(MotionDetection, FindsItAmongSpecksAndFlicker) {
  const MotionOptions options;
  const Tally tally = Count(options, kMovers, {.specks = 25, .flicker = true});
  EXPECT_GE(tally.hits, 3 * (16 - options.min_track_frames) - 4);
  EXPECT_LE(tally.false_alarms, 3);
}

TEST(MotionDetection, EachFilterRemovesFalseAlarms) {
  MotionOptions raw;
  raw.vote_share = 0;
  raw.forward_backward_margin_px = 0;
  raw.min_travel_px = 0;
  raw.min_track_frames = 1;
  raw.min_area_px = 4;
  const Clutter clutter = {.specks = 25, .flicker = true};
  const int without = Count(raw, {}, clutter).false_alarms;
  EXPECT_GT(without, 200);

  // What moves is still found. Following alone does not know where to look first.
  const int all = 3 * 16;
  EXPECT_EQ(Count(raw, kMovers, {}).hits, all);

  MotionOptions voting = raw;
  voting.vote_share = 0.6;
  voting.max_speed_px = 2.5;
  voting.min_speed_px = 0;
  EXPECT_LT(Count(voting, {}, clutter).false_alarms, without / 2);
  EXPECT_EQ(Count(voting, kMovers, {}).hits, all);

  MotionOptions following = raw;
  following.forward_backward_margin_px = 0.5;
  following.min_speed_px = 0;
  EXPECT_LT(Count(following, {}, clutter).false_alarms, without * 3 / 4);
  EXPECT_GE(Count(following, kMovers, {}).hits, all / 2);

  MotionOptions tracking = raw;
  tracking.min_travel_px = 3;
  tracking.min_track_frames = 4;
  EXPECT_LT(Count(tracking, {}, clutter).false_alarms, without / 2);
  EXPECT_GE(Count(tracking, kMovers, {}).hits, all - 3 * tracking.min_track_frames);
}

TEST(MotionDetection, WithoutFiltersNeighboursStayApart) {
  MotionOptions raw;
  raw.vote_share = 0;
  raw.forward_backward_margin_px = 0;
  raw.min_travel_px = 0;
  raw.min_track_frames = 1;
  const std::vector<Mover> abreast = {{40, 40, 20, 9, 2.0, 0.0}, {40, 59, 20, 9, 2.0, 0.0}};
  const Tally tally = Count(raw, abreast, {});
  EXPECT_EQ(tally.hits, 2 * 16);
  EXPECT_EQ(tally.false_alarms, 0);
}

// A thing of one grey cannot be followed; without voting nobody knows how it moves.
TEST(MotionDetection, FollowingAloneIsUndecidedWhereNothingCanBeFollowed) {
  MotionScene scene(kWidth, kHeight, MotionScene::Offsets(-10, 10));
  for (int f = 0; f < scene.frames(); ++f) {
    if (scene.offset(f) != 0) scene.Hide(f, 80, 60, 60, 60);
  }
  scene.AddMover(100, 80, 20, 12, 2.0, 0.0, 200, [](int offset) { return offset == 0; });
  MotionOptions following;
  following.vote_share = 0;
  following.min_travel_px = 0;
  following.min_track_frames = 1;
  MotionDetection detection(following);
  const auto& detections = detection.Detect(scene.Evidence());
  ASSERT_EQ(detections.size(), 1U);
  EXPECT_GT(Overlap(detections[0].box, {100, 80, 20, 12}), 0.5);
  EXPECT_NEAR(detections[0].score, 0.5 / 3, 1e-6);  // undecided, and seen in one frame
}

TEST(MotionDetection, KeepsIdsThroughAnOcclusion) {
  MotionDetection detection(MotionOptions{});
  const std::vector<Mover> movers = {{40, 40, 12, 8, 2.0, 1.0}};
  std::set<std::uint64_t> ids;
  int seen_after = 0;
  for (int frame = 0; frame < 24; ++frame) {
    const auto evidence = EvidenceAt(frame, movers, {}, [](int at) { return at < 12 || at >= 15; });
    for (const Detection& found : detection.Detect(evidence)) {
      ids.insert(found.track_id);
      EXPECT_GT(Overlap(found.box, movers[0].At(frame)), 0.5);
      if (frame >= 15) ++seen_after;
    }
  }
  EXPECT_EQ(ids.size(), 1U);
  EXPECT_GE(seen_after, 8);
}

// The grid is turned against the frame: boxes and velocities come in the frame's coordinates.
TEST(MotionDetection, GivesBoxesInFrameCoordinates) {
  MotionDetection detection(MotionOptions{});
  Eigen::Matrix3d frame_from_grid = Eigen::Matrix3d::Identity();
  frame_from_grid.topLeftCorner<2, 2>() =
      Eigen::Rotation2Dd(std::numbers::pi / 2).toRotationMatrix();
  frame_from_grid(0, 2) = kHeight - 1;
  const std::vector<Mover> movers = {{60, 60, 14, 8, 2.0, 0.0}};
  int found = 0;
  for (int frame = 0; frame < 12; ++frame) {
    MotionEvidence evidence = EvidenceAt(frame, movers);
    evidence.frame_from_grid = frame_from_grid;
    evidence.frame_width = kHeight;
    evidence.frame_height = kWidth;
    for (const Detection& detected : detection.Detect(evidence)) {
      const Box grid = movers[0].At(frame);
      const Box truth = {kHeight - grid.y - grid.height, grid.x, grid.height, grid.width};
      EXPECT_GT(Overlap(detected.box, truth), 0.6);
      EXPECT_NEAR(detected.velocity_px.x(), 0.0, 0.3);
      EXPECT_NEAR(detected.velocity_px.y(), 2.0, 0.3);
      ++found;
    }
  }
  EXPECT_GE(found, 8);
}

TEST(MotionDetection, IgnoresTheBorderOfTheFrame) {
  MotionDetection detection(MotionOptions{});
  for (int frame = 0; frame < 12; ++frame) {
    const std::vector<Mover> along = {{20, 0, 30, 3, 2.0, 0.0}};
    EXPECT_TRUE(detection.Detect(EvidenceAt(frame, along)).empty());
  }
}

TEST(MotionDetection, DropsWhatIsTooSlowOrTooLarge) {
  EXPECT_EQ(Count(MotionOptions{}, {{100, 80, 12, 8, 0.25, 0.0}}, {}).hits, 0);
  EXPECT_EQ(Count(MotionOptions{}, {{60, 60, 90, 20, 2.0, 0.0}}, {}).hits, 0);
  MotionOptions lenient;
  lenient.min_speed_px = 0.1;
  lenient.min_travel_px = 0.5;
  lenient.max_size = 1.0;
  EXPECT_GT(Count(lenient, {{60, 60, 90, 20, 2.0, 0.0}}, {}).hits, 8);
}

TEST(MotionDetection, Degenerate) {
  MotionDetection detection(MotionOptions{});
  EXPECT_TRUE(detection.Detect(MotionEvidence{}).empty());

  for (int i = 0; i < 6; ++i) {
    EXPECT_TRUE(detection.Detect(EvidenceAt(i, {})).empty());
    MotionScene flooded(kWidth, kHeight, MotionScene::Offsets(-10, 10));
    flooded.AddMover(0, 0, kWidth, kHeight, 0, 0, 250);
    EXPECT_TRUE(detection.Detect(flooded.Evidence()).empty());
    MotionScene lonely(kWidth, kHeight, {0});
    lonely.AddMover(20, 20, 9, 9, 0, 0, 250);
    EXPECT_TRUE(detection.Detect(lonely.Evidence()).empty());
    MotionScene tiny(1, 1, MotionScene::Offsets(-2, 2));
    tiny.AddMover(0, 0, 1, 1, 0, 0, 250);
    EXPECT_TRUE(detection.Detect(tiny.Evidence()).empty());
  }
}

}  // namespace
}  // namespace windhover
