// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "service/vision/background.h"
#include "service/vision/homography.h"
#include "tests/support/allocation_count.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

constexpr int kWidth = 240;
constexpr int kHeight = 180;
constexpr int kObjectSize = 10;

Eigen::Matrix3d Camera(int t) {
  return CameraMotion(kWidth, kHeight, 0.004 * t, 1.0, 3.0 * t, -1.5 * t);
}

// A bright square that drives over the ground at 4 px a frame: it covers a point in at most 3
// frames, under half of the shortest window (k + 1 frames at either end of the stream).
Eigen::Vector2d ObjectOnGround(int t) { return {70.0 + 4.0 * t, 70.0}; }

bool IsOnObject(int t, const Eigen::Vector2d& x_on_ground) {
  return (x_on_ground - ObjectOnGround(t)).cwiseAbs().maxCoeff() <= 0.5 * kObjectSize;
}

FrameRegistration TrueRegistration(int t, ReferenceMode mode) {
  // The anchor moves on at every eighth frame; each frame is measured against an older one.
  const int anchor = t == 0 ? 0 : (t - 1) / 8 * 8;
  FrameRegistration r;
  r.frame_number = t;
  r.starts_segment = t == 0;
  if (t > 0) r.previous_from_frame = Camera(t - 1).inverse() * Camera(t);
  r.previous_from_frame /= r.previous_from_frame(2, 2);
  r.anchor_number = anchor;
  if (mode == ReferenceMode::kAnchor) {
    const Eigen::Matrix3d m = Camera(anchor).inverse() * Camera(t);
    r.anchor_from_frame = m / m(2, 2);
  }
  return r;
}

class BackgroundTest : public testing::TestWithParam<ReferenceMode> {
 protected:
  BackgroundTest() : frame_(backend_->MakeImage<std::uint8_t>(kWidth, kHeight)) {
    registration_.tile_columns = registration_.tile_rows = 4;
    registration_.reference = GetParam();
  }

  const GrayImage& Frame(int t) {
    const Eigen::Matrix3d camera = Camera(t);
    ground_.Render(camera, 1.0, t, frame_, [&](int x, int y, double v) {
      return IsOnObject(t, Project(camera, Eigen::Vector2d(x, y))) ? 250.0 : v;
    });
    return frame_;
  }
  BackgroundSubtraction Make() {
    return BackgroundSubtraction(backend_, kWidth, kHeight, options_, registration_);
  }

  std::shared_ptr<Backend> backend_ = Backend::Create("cpu");
  BackgroundOptions options_{.k = 6, .lookahead = 6};
  RegistrationOptions registration_;
  SyntheticGround ground_;
  GrayImage frame_;
};

// Seeds of a sample, split by whether they lie on the object; `covered` is the share of the object
// that is marked.
struct SeedCount {
  int on_object = 0;
  int elsewhere = 0;
};

SeedCount CountSeeds(const MotionEvidence& evidence, int centre_t, int offset) {
  const auto& sample = evidence.samples.at(evidence.centre + offset);
  EXPECT_EQ(sample.offset_frames, offset);
  const auto words = sample.seeds->words.Read();
  // The grid lies over the centre frame; the object is looked up where it was at the sample's time.
  const Eigen::Matrix3d ground_from_grid = Camera(centre_t) * evidence.frame_from_grid;
  SeedCount count;
  for (int y = 0; y < sample.seeds->height; ++y) {
    for (int x = 0; x < sample.seeds->width; ++x) {
      if ((words.at(x / 32, y) >> (x % 32) & 1U) == 0) continue;
      const Eigen::Vector2d ground = Project(ground_from_grid, Eigen::Vector2d(x, y));
      const bool near = (ground - ObjectOnGround(centre_t + offset)).cwiseAbs().maxCoeff() <=
                        0.5 * kObjectSize + 1.0;
      ++(near ? count.on_object : count.elsewhere);
    }
  }
  return count;
}

TEST_P(BackgroundTest, MarksTheMoverAndNothingElse) {
  BackgroundSubtraction background = Make();
  int out = 0;
  const auto check = [&] {
    while (const auto evidence = background.Pop()) {
      const int t = out++;
      ASSERT_EQ(evidence->registration.frame_number, t);
      ASSERT_LT(evidence->centre, evidence->samples.size());
      EXPECT_EQ(evidence->samples[evidence->centre].offset_frames, 0);
      for (const int offset : {-3, 0, 3}) {
        if (t + offset < 0 || t + offset >= 30) continue;
        const SeedCount count = CountSeeds(*evidence, t, offset);
        EXPECT_GT(count.on_object, 0.75 * kObjectSize * kObjectSize) << t << " " << offset;
        EXPECT_LT(count.elsewhere, 12) << t << " " << offset;
      }
      // The background shows the ground under the object.
      const Eigen::Vector2d x_in_grid = Project(InverseHomography(evidence->frame_from_grid),
                                                Project(Camera(t).inverse(), ObjectOnGround(t)));
      const auto view = evidence->background->Read();
      EXPECT_NEAR(view.at(std::lround(x_in_grid.x()), std::lround(x_in_grid.y())),
                  ground_.At(ObjectOnGround(t).x(), ObjectOnGround(t).y()), 12.0);
    }
  };
  for (int t = 0; t < 30; ++t) {
    background.Push(Frame(t), TrueRegistration(t, GetParam()));
    check();
    EXPECT_EQ(out, std::max(0, t + 1 - 6));
  }
  background.Drain();
  check();
  EXPECT_EQ(out, 30);
}

TEST_P(BackgroundTest, LookaheadIsTheDelay) {
  for (const int lookahead : {0, 1, 4, 40}) {
    options_.lookahead = lookahead;
    BackgroundSubtraction background = Make();
    EXPECT_EQ(background.lookahead(), std::min(lookahead, 6));
    for (int t = 0; t < 10; ++t) {
      background.Push(Frame(t), TrueRegistration(t, GetParam()));
      const auto evidence = background.Pop();
      ASSERT_EQ(evidence != nullptr, t >= background.lookahead()) << lookahead;
      if (evidence == nullptr) continue;
      EXPECT_EQ(evidence->registration.frame_number, t - background.lookahead());
      EXPECT_EQ(evidence->samples.back().offset_frames, background.lookahead());
      EXPECT_EQ(background.Pop(), nullptr);
    }
  }
}

TEST_P(BackgroundTest, WindowsDoNotReachOverACut) {
  BackgroundSubtraction background = Make();
  int out = 0;
  for (int t = 0; t < 12; ++t) {
    FrameRegistration registration = TrueRegistration(t, GetParam());
    if (t == 5) {
      registration.starts_segment = true;
      registration.quality = RegistrationQuality::kLost;
    }
    if (t >= 5 && GetParam() == ReferenceMode::kAnchor) {
      const Eigen::Matrix3d m = Camera(5).inverse() * Camera(t);
      registration.anchor_number = 5;
      registration.anchor_from_frame = m / m(2, 2);
    }
    background.Push(Frame(t), registration);
    if (t == 11) background.Drain();
    while (const auto evidence = background.Pop()) {
      const int centre = out++;
      for (const auto& sample : evidence->samples) {
        EXPECT_EQ(centre + sample.offset_frames >= 5, centre >= 5);
      }
    }
    if (t == 5) EXPECT_EQ(out, 5);  // what lies before the cut waits for nothing
  }
  EXPECT_EQ(out, 12);
}

TEST_P(BackgroundTest, ResetLeavesNothingBehind) {
  BackgroundSubtraction background = Make();
  for (int t = 0; t < 5; ++t) background.Push(Frame(t), TrueRegistration(t, GetParam()));
  background.Reset();
  background.Drain();
  EXPECT_EQ(background.Pop(), nullptr);
  background.Push(Frame(0), TrueRegistration(0, GetParam()));
  background.Drain();
  const auto evidence = background.Pop();
  ASSERT_NE(evidence, nullptr);
  EXPECT_EQ(evidence->samples.size(), 1);
  EXPECT_EQ(CountSeeds(*evidence, 0, 0).on_object, 0);  // a single frame shows no motion
}

TEST_P(BackgroundTest, DoesNotAllocateOnceWarm) {
  BackgroundSubtraction background = Make();
  std::size_t before = 0;
  for (int t = 0; t < 60; ++t) {
    const GrayImage& frame = Frame(t);
    const FrameRegistration registration = TrueRegistration(t, GetParam());
    if (t == 45) before = AllocationCount();
    const std::size_t at_start = AllocationCount();
    background.Push(frame, registration);
    while (background.Pop() != nullptr) {
    }
    if (t >= 45) {
      EXPECT_EQ(AllocationCount(), at_start) << t;
    }
  }
  EXPECT_GT(before, 0U);  // the counter counts
}

INSTANTIATE_TEST_SUITE_P(Modes, BackgroundTest,
                         testing::Values(ReferenceMode::kAnchor, ReferenceMode::kCentre),
                         [](const auto& info) {
                           return info.param == ReferenceMode::kAnchor ? "Anchor" : "Centre";
                         });

}  // namespace
}  // namespace windhover
