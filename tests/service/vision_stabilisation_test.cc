// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "service/vision/stabilisation.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr double kFrameRateHz = 25.0;

using Camera = std::function<Eigen::Matrix3d(int t)>;  // ground_from_frame

Eigen::Matrix3d Shift(double x, double y) { return CameraMotion(kWidth, kHeight, 0.0, 1.0, x, y); }

Eigen::Vector2d Centre() { return {0.5 * (kWidth - 1), 0.5 * (kHeight - 1)}; }

// As whregister says it: to the frame before and to an anchor that moves on every seventh frame.
FrameRegistration Registration(const Camera& ground_from_frame, int t) {
  FrameRegistration r;
  r.frame_number = static_cast<std::uint64_t>(t);
  r.starts_segment = t == 0;
  const int anchor = t == 0 ? 0 : (t - 1) / 7 * 7;
  r.anchor_number = static_cast<std::uint64_t>(anchor);
  const auto between = [&](int to) {
    const Eigen::Matrix3d h = ground_from_frame(to).inverse() * ground_from_frame(t);
    return Eigen::Matrix3d(h / h(2, 2));
  };
  if (t > 0) r.previous_from_frame = between(t - 1);
  r.anchor_from_frame = between(anchor);
  return r;
}

FrameRegistration Lost(int t) {
  FrameRegistration r;
  r.frame_number = r.anchor_number = static_cast<std::uint64_t>(t);
  r.anchor_from_frame = Eigen::Matrix3d::Identity();
  r.starts_segment = true;
  r.quality = RegistrationQuality::kLost;
  return r;
}

std::vector<ScreenPose> PosesOf(Stabilisation& stabilisation,
                                const std::vector<FrameRegistration>& registrations) {
  std::vector<ScreenPose> poses;
  const auto pop = [&] {
    while (const auto pose = stabilisation.Pop()) poses.push_back(*pose);
  };
  for (const FrameRegistration& registration : registrations) {
    stabilisation.Push(registration);
    pop();
  }
  stabilisation.Drain();
  pop();
  return poses;
}

std::vector<ScreenPose> PosesOf(const StabilisationOptions& options, const Camera& camera,
                                int frames) {
  Stabilisation stabilisation(kWidth, kHeight, options, kFrameRateHz);
  std::vector<FrameRegistration> registrations;
  registrations.reserve(frames);
  for (int t = 0; t < frames; ++t) registrations.push_back(Registration(camera, t));
  return PosesOf(stabilisation, registrations);
}

// Where on the screen a point of the ground is seen.
Eigen::Vector2d OnScreen(const ScreenPose& pose, const Eigen::Matrix3d& ground_from_frame,
                         const Eigen::Vector2d& x_on_ground) {
  return Project(pose.screen_from_frame * ground_from_frame.inverse(), x_on_ground);
}

Camera Shaking(double sigma_px, double pan_px) {
  return [=](int t) {
    std::mt19937 random(static_cast<unsigned>(t) + 1);
    std::normal_distribution<double> normal(0.0, 1.0);
    const double turn = 0.3 * sigma_px / kWidth * normal(random);
    const double x = pan_px * t + sigma_px * normal(random);
    return CameraMotion(kWidth, kHeight, turn, 1.0, x, sigma_px * normal(random));
  };
}

StabilisationOptions Smooth(int lookahead) {
  StabilisationOptions options;
  options.mode = StabilisationMode::kSmooth;
  options.smoothing_lookahead = lookahead;
  return options;
}

class StabilisationNominal : public testing::Test {};

TEST_F(StabilisationNominal, TheGroundKeepsItsPlaceThroughChangesOfAnchor) {
  const Camera camera = [](int t) {
    return CameraMotion(kWidth, kHeight, 0.02 * std::sin(0.9 * t), 1.0 + 0.01 * std::cos(0.7 * t),
                        9.0 * std::sin(1.3 * t), 7.0 * std::cos(1.1 * t) - 7.0, 1e-5);
  };
  const auto poses = PosesOf({}, camera, 60);
  ASSERT_EQ(poses.size(), 60u);
  for (const Eigen::Vector2d& x : PictureCorners(kWidth, kHeight)) {
    const Eigen::Vector2d at_start = OnScreen(poses[0], camera(0), x);
    for (int t = 0; t < 60; ++t) {
      EXPECT_LT((OnScreen(poses[t], camera(t), x) - at_start).norm(), 1e-6) << t;
    }
  }
}

TEST_F(StabilisationNominal, ACropEnlargesAboutTheCentre) {
  StabilisationOptions options;
  options.crop = 0.2;
  const auto poses = PosesOf(options, Shaking(0.0, 0.0), 3);
  EXPECT_LT((Project(poses[2].screen_from_frame, Centre()) - Centre()).norm(), 1e-9);
  const Eigen::Vector2d x = Project(poses[2].screen_from_frame, {0.1 * (kWidth - 1), 0.0});
  EXPECT_NEAR(x.x(), 0.0, 1e-9);
}

// What is off the screen stays below the stated share, and the picture glides: its speed over the
// screen changes by little from frame to frame.
TEST_F(StabilisationNominal, AnchorModeCentresAnewInAGlide) {
  StabilisationOptions options;
  options.max_off_screen = 0.2;
  const Camera camera = Shaking(0.0, 3.0);
  constexpr int kFrames = 200;
  const auto poses = PosesOf(options, camera, kFrames);
  std::vector<Eigen::Vector2d> screen_on_ground;
  double least_covered = 1.0;
  int still = 0;
  for (int t = 0; t < kFrames; ++t) {
    screen_on_ground.push_back(Project(camera(t) * poses[t].screen_from_frame.inverse(), Centre()));
    least_covered =
        std::min(least_covered, CoveredShare(poses[t].screen_from_frame, kWidth, kHeight));
    if (t > 0 && (screen_on_ground[t] - screen_on_ground[t - 1]).norm() < 1e-6) ++still;
    if (t > 1) {
      const Eigen::Vector2d change =
          screen_on_ground[t] - 2.0 * screen_on_ground[t - 1] + screen_on_ground[t - 2];
      EXPECT_LT(change.norm(), 1.5) << t;
    }
  }
  EXPECT_GT(least_covered, 0.75);
  EXPECT_LT(least_covered, 0.81) << "it held on for as long as it could";
  EXPECT_GT(still, kFrames / 4);
  EXPECT_GT(screen_on_ground.back().x(), 3.0 * kFrames - 0.3 * kWidth) << "it went along";
}

TEST_F(StabilisationNominal, NoCameraIsTooFast) {
  StabilisationOptions options;
  for (const double pan : {20.0, 60.0, 250.0}) {
    const auto poses = PosesOf(options, Shaking(2.0, pan), 80);
    for (const ScreenPose& pose : poses) {
      EXPECT_GE(CoveredShare(pose.screen_from_frame, kWidth, kHeight), 0.5 - 1e-3) << pan;
    }
  }
}

// A picture that turns while it glides keeps its size.
TEST_F(StabilisationNominal, AnchorModeFollowsATurn) {
  const auto poses = PosesOf(
      {}, [](int t) { return CameraMotion(kWidth, kHeight, 0.01 * t, 1.0, 0.0, 0.0); }, 300);
  double turn = 0.0;
  for (const ScreenPose& pose : poses) {
    EXPECT_NEAR(pose.screen_from_frame.determinant(), 1.0, 0.02);
    turn = std::max(
        turn, std::abs(std::atan2(pose.screen_from_frame(1, 0), pose.screen_from_frame(0, 0))));
  }
  EXPECT_GT(turn, 0.2) << "it is held until then";
  EXPECT_LT(turn, 2.0);
}

// A camera that zooms out would otherwise show ever less of its picture.
TEST_F(StabilisationNominal, AnchorModeFollowsAZoom) {
  for (const double zoom : {1.02, 1.0 / 1.02}) {
    const auto poses = PosesOf(
        {}, [=](int t) { return CameraMotion(kWidth, kHeight, 0.0, std::pow(zoom, t), 0, 0); },
        200);
    for (const ScreenPose& pose : poses) {
      const Eigen::Vector2d size = Project(pose.screen_from_frame, {kWidth - 1, 0}) -
                                   Project(pose.screen_from_frame, {0, 0});
      EXPECT_GT(size.x(), 0.65 * kWidth);
      EXPECT_LT(size.x(), 1.5 * kWidth);
    }
  }
}

// The energy of the second differences of a ground point's way over the screen.
double JitterEnergy(const std::vector<Eigen::Vector2d>& way) {
  double sum = 0.0;
  for (std::size_t t = 2; t < way.size(); ++t) {
    sum += (way[t] - 2.0 * way[t - 1] + way[t - 2]).squaredNorm();
  }
  return sum;
}

struct SmoothCase {
  int lookahead;
  double factor;  // by which the energy of the jitter must fall
};
void PrintTo(const SmoothCase& c, std::ostream* out) { *out << c.lookahead << " frames"; }

class SmoothTest : public testing::TestWithParam<SmoothCase> {};

TEST_P(SmoothTest, JitterFallsWhileThePictureFollows) {
  const auto [lookahead, factor] = GetParam();
  const Camera camera = Shaking(3.0, 2.0);
  constexpr int kFrames = 200;
  const auto poses = PosesOf(Smooth(lookahead), camera, kFrames);
  ASSERT_EQ(poses.size(), static_cast<std::size_t>(kFrames));
  std::vector<Eigen::Vector2d> before;
  std::vector<Eigen::Vector2d> after;
  for (int t = 50; t < kFrames; ++t) {
    before.push_back(Project(camera(t), Centre()));
    after.push_back(Project(camera(t) * poses[t].screen_from_frame.inverse(), Centre()));
    EXPECT_LT((after.back() - before.back()).norm(), 15.0) << t;
  }
  EXPECT_GT(JitterEnergy(before), factor * JitterEnergy(after));
  RecordProperty("factor", static_cast<int>(JitterEnergy(before) / JitterEnergy(after)));
}

INSTANTIATE_TEST_SUITE_P(Lookaheads, SmoothTest,
                         testing::Values(SmoothCase{0, 30.0}, SmoothCase{5, 100.0},
                                         SmoothCase{25, 400.0}),
                         [](const auto& info) {
                           return "Frames" + std::to_string(info.param.lookahead);
                         });

TEST_F(StabilisationNominal, ASteadyCameraIsFollowedWithoutLag) {
  for (const int lookahead : {0, 10}) {
    const auto poses = PosesOf(Smooth(lookahead), Shaking(0.0, 4.0), 60);
    for (const ScreenPose& pose : poses) {
      EXPECT_LT(HomographyRms(pose.screen_from_frame, Eigen::Matrix3d::Identity(), kWidth, kHeight),
                1e-6);
    }
  }
}

TEST_F(StabilisationNominal, ACropKeepsBordersOutOfSight) {
  StabilisationOptions options = Smooth(5);
  options.crop = 0.1;
  const auto poses = PosesOf(options, Shaking(14.0, 1.0), 120);
  double largest = 0.0;
  for (const ScreenPose& pose : poses) {
    const Eigen::Matrix3d frame_from_screen = pose.screen_from_frame.inverse();
    for (const Eigen::Vector2d& x : PictureCorners(kWidth, kHeight)) {
      const Eigen::Vector2d at = Project(frame_from_screen, x);
      EXPECT_GE(at.minCoeff(), -0.05);
      EXPECT_LE(at.x(), kWidth - 0.95);
      EXPECT_LE(at.y(), kHeight - 0.95);
    }
    largest = std::max(largest, (Project(frame_from_screen, Centre()) - Centre()).norm());
  }
  EXPECT_GT(largest, 10.0) << "it does steady the picture, too";
}

TEST_F(StabilisationNominal, EachFrameComesOutOnceBehindTheLookahead) {
  for (const auto& [lookahead, held] : {std::pair{0, 0}, {4, 4}, {120, 25}}) {
    Stabilisation stabilisation(kWidth, kHeight, Smooth(lookahead), kFrameRateHz);
    EXPECT_EQ(stabilisation.lookahead(), held);
    int out = 0;
    for (int t = 0; t < 40; ++t) {
      stabilisation.Push(Registration(Shaking(1.0, 0.0), t));
      while (stabilisation.Pop()) ++out;
      EXPECT_EQ(out, std::max(0, t + 1 - held));
    }
    stabilisation.Drain();
    while (stabilisation.Pop()) ++out;
    EXPECT_EQ(out, 40);
  }
  StabilisationOptions anchor;
  anchor.smoothing_lookahead = 10;
  EXPECT_EQ(Stabilisation(kWidth, kHeight, anchor, kFrameRateHz).lookahead(), 0);
}

TEST_F(StabilisationNominal, ALostFrameIsShownWhereTheLastOneWasAndTheRestGlidesBack) {
  for (const StabilisationMode mode : {StabilisationMode::kAnchor, StabilisationMode::kSmooth}) {
    StabilisationOptions options;
    options.mode = mode;
    options.smoothing_lookahead = 0;
    const Camera camera = [](int t) { return Shift(t < 20 ? 0.0 : 30.0, 0.0); };
    std::vector<FrameRegistration> registrations;
    for (int t = 0; t < 22; ++t) registrations.push_back(Registration(camera, t));
    for (int t = 22; t < 26; ++t) registrations.push_back(Lost(t));
    for (int t = 26; t < 60; ++t) registrations.push_back(Registration(camera, t));
    // Registered to an anchor from before the loss they are not.
    Stabilisation stabilisation(kWidth, kHeight, options, kFrameRateHz);
    const auto poses = PosesOf(stabilisation, registrations);
    const Eigen::Matrix3d held = poses[21].screen_from_frame;
    EXPECT_GT(held(0, 2), 10.0);
    for (int t = 22; t < 27; ++t) {
      EXPECT_LT(HomographyRms(poses[t].screen_from_frame, held, kWidth, kHeight), 1.0) << t;
      EXPECT_EQ(poses[t].continues, t == 26) << t;
    }
    for (int t = 22; t < 60; ++t) {
      const double step = HomographyRms(poses[t].screen_from_frame, poses[t - 1].screen_from_frame,
                                        kWidth, kHeight);
      EXPECT_LT(step, 3.0) << t;
    }
    EXPECT_LT(
        HomographyRms(poses[59].screen_from_frame, Eigen::Matrix3d::Identity(), kWidth, kHeight),
        1e-3);
  }
}

TEST_F(StabilisationNominal, MissingFramesAreBridgedByTheAnchor) {
  const Camera camera = Shaking(3.0, 0.0);
  Stabilisation stabilisation(kWidth, kHeight, {}, kFrameRateHz);
  // 7 is the anchor of 8 to 14, 14 that of 15 to 21: 10 to 12 follow 8, 17 follows 14.
  std::vector<FrameRegistration> registrations;
  const std::vector<int> numbers = {0, 1, 2, 5, 7, 8, 12, 14, 17, 17};
  for (const int t : numbers) registrations.push_back(Registration(camera, t));
  const auto poses = PosesOf(stabilisation, registrations);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].continues, i > 0) << numbers[i];
    EXPECT_LT((OnScreen(poses[i], camera(numbers[i]), Centre()) - Centre()).norm(),
              (Project(camera(0).inverse(), Centre()) - Centre()).norm() + 1e-6);
    EXPECT_LT(
        (OnScreen(poses[i], camera(numbers[i]), Centre()) - OnScreen(poses[0], camera(0), Centre()))
            .norm(),
        1e-6);
  }
  // Nothing ties frame 40 to what came before.
  Stabilisation other(kWidth, kHeight, {}, kFrameRateHz);
  const auto cut = PosesOf(other, {Registration(camera, 0), Registration(camera, 40)});
  EXPECT_FALSE(cut[1].continues);
}

// Each pose says how its screen lies on the screen before, and on that of its reference.
TEST_F(StabilisationNominal, ScreensAreTiedToEachOther) {
  const Camera camera = Shaking(2.0, 3.0);
  for (const StabilisationMode mode : {StabilisationMode::kAnchor, StabilisationMode::kSmooth}) {
    StabilisationOptions options = Smooth(4);
    options.mode = mode;
    const auto poses = PosesOf(options, camera, 60);
    for (int t = 1; t < 60; ++t) {
      const Eigen::Vector2d x = Project(camera(t), {30.0, 50.0});
      EXPECT_LT((Project(poses[t].previous_screen_from_screen, OnScreen(poses[t], camera(t), x)) -
                 OnScreen(poses[t - 1], camera(t - 1), x))
                    .norm(),
                1e-6);
      const auto anchor = static_cast<int>(poses[t].anchor_number);
      EXPECT_EQ(anchor, (t - 1) / 7 * 7);
      EXPECT_LT((poses[t].reference_screen_from_reference - poses[anchor].screen_from_frame).norm(),
                1e-9);
    }
  }
}

TEST(StabilisationNoiseStability, NoiseOfTheRegistrationDoesNotShakeTheHeldGround) {
  // Measured against anchors, errors do not add up within one anchor's time.
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.05);
  const Camera truth = Shaking(4.0, 0.0);
  std::vector<FrameRegistration> registrations;
  Eigen::Matrix3d previous_error = Eigen::Matrix3d::Identity();
  for (int t = 0; t < 100; ++t) {
    FrameRegistration r = Registration(truth, t);
    const Eigen::Matrix3d error = Shift(noise(random), noise(random));
    r.previous_from_frame = previous_error.inverse() * r.previous_from_frame * error;
    previous_error = error;
    registrations.push_back(r);
  }
  Stabilisation stabilisation(kWidth, kHeight, {}, kFrameRateHz);
  const auto poses = PosesOf(stabilisation, registrations);
  const Eigen::Vector2d start = OnScreen(poses[0], truth(0), Centre());
  for (int t = 0; t < 100; ++t) {
    EXPECT_LT((OnScreen(poses[t], truth(t), Centre()) - start).norm(), 0.3);
  }
}

// An hour's flight over oblique ground: what was seen at its start lies beyond all numbers.
TEST(StabilisationNumericalStability, LongFlightsDoNotWearOut) {
  const Eigen::Matrix3d step = CameraMotion(kWidth, kHeight, 0.001, 1.003, 1.5, -1.0, 2e-6);
  for (const StabilisationMode mode : {StabilisationMode::kAnchor, StabilisationMode::kSmooth}) {
    StabilisationOptions options = Smooth(2);
    options.mode = mode;
    options.smoothing_s = 0.4;
    Stabilisation stabilisation(kWidth, kHeight, options, kFrameRateHz);
    for (int t = 0; t < 50000; ++t) {
      FrameRegistration r;
      r.frame_number = static_cast<std::uint64_t>(t);
      r.starts_segment = t == 0;
      if (t > 0) r.previous_from_frame = step;
      stabilisation.Push(r);
      while (const auto pose = stabilisation.Pop()) {
        ASSERT_TRUE(IsOrientationPreserving(pose->screen_from_frame, kWidth, kHeight)) << t;
        ASSERT_GT(CoveredShare(pose->screen_from_frame, kWidth, kHeight), 0.49) << t;
      }
    }
  }
}

TEST(StabilisationDegenerate, WildHomographiesMakeNoWildPoses) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::Matrix3d mirrored = Eigen::Matrix3d::Identity();
  mirrored(0, 0) = -1.0;
  Eigen::Matrix3d horizon = Eigen::Matrix3d::Identity();
  horizon(2, 0) = -1.0 / 100.0;
  const std::vector<Eigen::Matrix3d> wild = {
      mirrored,
      horizon,
      Eigen::Matrix3d::Zero(),
      Eigen::Matrix3d::Constant(nan),
      Eigen::Matrix3d::Constant(std::numeric_limits<double>::infinity()),
      CameraMotion(kWidth, kHeight, 3.1, 1.0, 0.0, 0.0),
      CameraMotion(kWidth, kHeight, 0.0, 40.0, 0.0, 0.0),
      CameraMotion(kWidth, kHeight, 0.0, 0.01, 0.0, 0.0),
      Shift(1e9, 0.0),
      CameraMotion(kWidth, kHeight, 0.5, 1.0, 0.0, 0.0, 5e-3)};
  for (const StabilisationMode mode : {StabilisationMode::kAnchor, StabilisationMode::kSmooth}) {
    for (const double crop : {0.0, 0.1}) {
      for (std::size_t i = 0; i < wild.size(); ++i) {
        StabilisationOptions options = Smooth(3);
        options.mode = mode;
        options.crop = crop;
        std::vector<FrameRegistration> registrations;
        for (int t = 0; t < 90; ++t) {
          registrations.push_back(Registration(Shaking(2.0, 1.0), t));
          if (t == 30) registrations.back().previous_from_frame = wild[i];
        }
        Stabilisation stabilisation(kWidth, kHeight, options, kFrameRateHz);
        const auto poses = PosesOf(stabilisation, registrations);
        ASSERT_EQ(poses.size(), 90u);
        for (const ScreenPose& pose : poses) {
          ASSERT_TRUE(IsOrientationPreserving(pose.screen_from_frame, kWidth, kHeight)) << i;
          ASSERT_GT(CoveredShare(pose.screen_from_frame, kWidth, kHeight), 0.49) << i;
          ASSERT_TRUE(pose.previous_screen_from_screen.allFinite()) << i;
        }
        EXPECT_GT(CoveredShare(poses.back().screen_from_frame, kWidth, kHeight), 0.7) << i;
      }
    }
  }
}

TEST(StabilisationDegenerate, OptionsOutOfRangeAreRefused) {
  StabilisationOptions options;
  options.crop = 0.9;
  EXPECT_THROW(Stabilisation(kWidth, kHeight, options, kFrameRateHz), OptionError);
}

TEST(ScreenPose, SharesAreAreas) {
  EXPECT_DOUBLE_EQ(CoveredShare(Eigen::Matrix3d::Identity(), 101, 51), 1.0);
  EXPECT_NEAR(CoveredShare(CameraMotion(101, 51, 0.0, 1.0, 25.0, 0.0), 101, 51), 0.75, 1e-12);
  EXPECT_NEAR(CoveredShare(CameraMotion(101, 51, 0.0, 0.5, 0.0, 0.0), 101, 51), 0.25, 1e-12);
  EXPECT_DOUBLE_EQ(CoveredShare(CameraMotion(101, 51, 0.0, 1.0, 500.0, 0.0), 101, 51), 0.0);
  // A square that is turned by an eighth leaves the corners of another: area 2 (sqrt(2) - 1).
  EXPECT_NEAR(CoveredShare(CameraMotion(101, 101, M_PI / 4, 1.0, 0.0, 0.0), 101, 101),
              2.0 * (std::sqrt(2.0) - 1.0), 1e-12);
}

TEST(ScreenPose, BlendsLeadFromOneToTheOther) {
  const Eigen::Matrix3d a = CameraMotion(kWidth, kHeight, -3.0, 1.0, 40.0, -9.0, 1e-4);
  const Eigen::Matrix3d b = CameraMotion(kWidth, kHeight, 3.0, 1.3, -5.0, 0.0);
  const auto blend = [&](double share) { return BlendHomographies(a, b, share, kWidth, kHeight); };
  EXPECT_LT(HomographyRms(blend(0.0), a, kWidth, kHeight), 1e-9);
  EXPECT_LT(HomographyRms(blend(1.0), b, kWidth, kHeight), 1e-9);
  // The shorter way leads through half a turn.
  EXPECT_LT(blend(0.5)(0, 0), -1.0);
}

TEST(ScreenPose, HomographyOfItsCorners) {
  const Eigen::Matrix3d h = CameraMotion(kWidth, kHeight, 0.3, 1.2, 40.0, -9.0, 1e-4);
  auto corners = PictureCorners(kWidth, kHeight);
  for (Eigen::Vector2d& x : corners) x = Project(h, x);
  EXPECT_LT(HomographyRms(HomographyOfCorners(corners, kWidth, kHeight), h, kWidth, kHeight), 1e-9);
}

}  // namespace
}  // namespace windhover
