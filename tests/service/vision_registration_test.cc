// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "service/vision/global_motion.h"
#include "service/vision/homography.h"
#include "service/vision/registration.h"
#include "service/vision/tile_layout.h"
#include "service/vision/tile_registration.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 241;

class StreamRegistrationTest : public testing::TestWithParam<ReferenceMode> {
 protected:
  StreamRegistrationTest() : frame_(backend_->MakeImage<std::uint8_t>(kWidth, kHeight)) {
    options_.reference = GetParam();
  }

  std::unique_ptr<StreamRegistration> Make() {
    return std::make_unique<StreamRegistration>(backend_, kWidth, kHeight, options_);
  }
  const GrayImage& Frame(const Eigen::Matrix3d& ground_from_frame, double noise_sigma = 2.0) {
    ground_.Render(ground_from_frame, noise_sigma, ++noise_seed_, frame_);
    return frame_;
  }
  const GrayImage& Constant(std::uint8_t value) {
    const auto view = frame_.Write();
    for (int y = 0; y < kHeight; ++y) std::fill_n(view.row(y), kWidth, value);
    return frame_;
  }

  std::shared_ptr<Backend> backend_ = Backend::Create("cpu");
  RegistrationOptions options_;
  SyntheticGround ground_;
  GrayImage frame_;
  std::uint32_t noise_seed_ = 0;
};

Eigen::Matrix3d Flight(int t, double shift_px, double radians) {
  return CameraMotion(kWidth, kHeight, radians * t, 1.0 + 0.001 * t, shift_px * t,
                      -0.6 * shift_px * t, 1e-6 * t);
}

TEST_P(StreamRegistrationTest, Nominal) {
  const auto registration = Make();
  Eigen::Matrix3d before = Eigen::Matrix3d::Identity();
  for (int t = 0; t < 30; ++t) {
    const Eigen::Matrix3d ground_from_frame = Flight(t, 4.0, 0.006);
    const FrameRegistration r = registration->Register(Frame(ground_from_frame));
    EXPECT_EQ(r.frame_number, t);
    EXPECT_EQ(r.starts_segment, t == 0);
    ASSERT_EQ(r.quality, RegistrationQuality::kValid) << t;
    EXPECT_EQ(r.anchor_from_frame.has_value(), GetParam() == ReferenceMode::kAnchor);
    if (t > 0) {
      const Eigen::Matrix3d truth = before.inverse() * ground_from_frame;
      EXPECT_LT(HomographyRms(r.previous_from_frame, truth, kWidth, kHeight), 0.1) << t;
      EXPECT_GE(r.inliers, 24);
      EXPECT_EQ(r.tiles, 36);
      EXPECT_TRUE(r.corner_covariance.allFinite());
      EXPECT_GT(r.corner_covariance.trace(), 0.0);
    }
    before = ground_from_frame;
  }
}

TEST_P(StreamRegistrationTest, NoiseStability) {
  for (const double sigma : {5.0, 10.0}) {
    const auto registration = Make();
    for (int t = 0; t < 5; ++t) {
      const FrameRegistration r = registration->Register(Frame(Flight(t, 3.0, 0.002), sigma));
      ASSERT_NE(r.quality, RegistrationQuality::kLost);
      if (t == 0) continue;
      const Eigen::Matrix3d truth = Flight(t - 1, 3.0, 0.002).inverse() * Flight(t, 3.0, 0.002);
      EXPECT_LT(HomographyRms(r.previous_from_frame, truth, kWidth, kHeight), 0.03 * sigma);
    }
  }
}

TEST_P(StreamRegistrationTest, LargeJumpsAreFound) {
  // A third of the picture at once, with no motion before that would foretell it.
  const auto registration = Make();
  registration->Register(Frame(Eigen::Matrix3d::Identity()));
  const Eigen::Matrix3d jump = CameraMotion(kWidth, kHeight, 0.02, 1.0, 100, 40);
  const FrameRegistration r = registration->Register(Frame(jump));
  ASSERT_NE(r.quality, RegistrationQuality::kLost);
  EXPECT_LT(HomographyRms(r.previous_from_frame, jump, kWidth, kHeight), 0.2);
}

TEST_P(StreamRegistrationTest, TurnsAndZoomsAreFound) {
  const auto motion = [](double degrees, double zoom) {
    return CameraMotion(kWidth, kHeight, degrees * 3.14159265 / 180, zoom, 9, -7, 0);
  };
  for (const auto& [degrees, zoom] :
       {std::pair{10.0, 1.0}, {-11.0, 1.0}, {0.0, 1.1}, {0.0, 0.91}, {8.0, 1.08}, {-7.0, 0.93}}) {
    const auto registration = Make();
    registration->Register(Frame(Eigen::Matrix3d::Identity()));
    const FrameRegistration r = registration->Register(Frame(motion(degrees, zoom)));
    ASSERT_EQ(r.quality, RegistrationQuality::kValid) << degrees << ", " << zoom;
    EXPECT_LT(HomographyRms(r.previous_from_frame, motion(degrees, zoom), kWidth, kHeight), 0.2)
        << degrees << ", " << zoom;
  }
}

TEST_P(StreamRegistrationTest, WhatIsNotSureIsNotValid) {
  options_.max_error_px = 0.05;
  const auto strict = Make();
  const auto second_frame = [&](double noise_sigma) {
    strict->Reset();
    strict->Register(Frame(Flight(0, 3.0, 0.002), noise_sigma));
    return strict->Register(Frame(Flight(1, 3.0, 0.002), noise_sigma));
  };
  EXPECT_EQ(second_frame(1.0).quality, RegistrationQuality::kValid);
  const FrameRegistration noisy = second_frame(20.0);
  EXPECT_GT(std::sqrt(noisy.corner_covariance.trace() / 4.0), 0.05);
  EXPECT_EQ(noisy.quality, RegistrationQuality::kDegraded);
}

TEST_P(StreamRegistrationTest, FinerTilesMakeItSurer) {
  const auto variance = [&](double refine_above_px) {
    options_.refine_above_px = refine_above_px;
    const auto registration = Make();
    registration->Register(Frame(Flight(0, 3.0, 0.002), 10.0));
    return registration->Register(Frame(Flight(1, 3.0, 0.002), 10.0)).corner_covariance.trace();
  };
  EXPECT_LT(variance(0.0), 0.8 * variance(100.0));
}

TEST_P(StreamRegistrationTest, IdentityInIdentityOut) {
  const auto registration = Make();
  registration->Register(Frame(Eigen::Matrix3d::Identity(), 0.0));
  const FrameRegistration r = registration->Register(Frame(Eigen::Matrix3d::Identity(), 0.0));
  ASSERT_EQ(r.quality, RegistrationQuality::kValid);
  EXPECT_LT(HomographyRms(r.previous_from_frame, Eigen::Matrix3d::Identity(), kWidth, kHeight),
            1e-3);
}

// The thesis' 13 layouts; four matches leave nothing to check a homography with.
TEST(TileRegistrationTest, EveryLayoutRegisters) {
  struct Case {
    int columns, rows, layers, tiles;
  };
  constexpr int kLargeWidth = 640;
  constexpr int kLargeHeight = 481;
  const auto backend = Backend::Create("cpu");
  const SyntheticGround ground;
  GrayImage reference = backend->MakeImage<std::uint8_t>(kLargeWidth, kLargeHeight);
  GrayImage frame = backend->MakeImage<std::uint8_t>(kLargeWidth, kLargeHeight);
  const Eigen::Matrix3d truth = CameraMotion(kLargeWidth, kLargeHeight, 0.004, 1.002, 6, -4, 0);
  ground.Render(Eigen::Matrix3d::Identity(), 2.0, 1, reference);
  ground.Render(truth, 2.0, 2, frame);
  for (const Case& c : {Case{2, 2, 1, 4},
                        {2, 2, 2, 5},
                        {4, 2, 1, 8},
                        {3, 3, 1, 9},
                        {4, 4, 1, 16},
                        {5, 5, 1, 25},
                        {4, 4, 2, 25},
                        {6, 6, 1, 36},
                        {8, 8, 1, 64},
                        {10, 10, 1, 100},
                        {15, 15, 1, 225}}) {
    RegistrationOptions options;
    options.tile_columns = c.columns;
    options.tile_rows = c.rows;
    options.tile_layers = c.layers;
    StreamRegistration registration(backend, kLargeWidth, kLargeHeight, options);
    EXPECT_EQ(registration.Register(reference).tiles, c.tiles);
    const FrameRegistration r = registration.Register(frame);
    EXPECT_EQ(r.tiles, c.tiles);
    EXPECT_EQ(r.quality,
              c.tiles == 4 ? RegistrationQuality::kDegraded : RegistrationQuality::kValid)
        << c.tiles;
    EXPECT_LT(HomographyRms(r.previous_from_frame, truth, kLargeWidth, kLargeHeight), 0.25)
        << c.tiles;
  }
}

TEST(TileRegistrationTest, RefusesAnAlphaThatItsWindowHasNoUseFor) {
  const auto backend = Backend::Create("cpu");
  RegistrationOptions options;
  options.window_alpha = 0.3;
  try {
    TileRegistration(*backend, kWidth, kHeight, options);
    FAIL() << "no error";
  } catch (const OptionError& error) {
    EXPECT_STREQ(error.what(), "option window-alpha = 0.3: with window = blackman it is 0 to 0.25");
  }
  options.window = WindowKind::kTukey;
  EXPECT_NO_THROW(TileRegistration(*backend, kWidth, kHeight, options));
}

TEST_P(StreamRegistrationTest, NoTextureIsLost) {
  for (const std::uint8_t value : {0, 128, 255}) {
    const auto registration = Make();
    for (int t = 0; t < 3; ++t) {
      const FrameRegistration r = registration->Register(Constant(value));
      EXPECT_EQ(r.quality, RegistrationQuality::kLost);
      EXPECT_TRUE(r.starts_segment);
      EXPECT_TRUE(r.previous_from_frame.isIdentity());
      EXPECT_TRUE(r.corner_covariance.isZero());
    }
  }
}

TEST_P(StreamRegistrationTest, ACutStartsANewSegment) {
  const auto registration = Make();
  registration->Register(Frame(Flight(0, 2, 0)));
  registration->Register(Frame(Flight(1, 2, 0)));
  Eigen::Matrix3d elsewhere = Eigen::Matrix3d::Identity();
  elsewhere.topRightCorner<2, 1>() << 4000, 7000;
  const FrameRegistration cut = registration->Register(Frame(elsewhere));
  EXPECT_EQ(cut.quality, RegistrationQuality::kLost);
  EXPECT_TRUE(cut.starts_segment);
  EXPECT_EQ(cut.frame_number, 2);
  const FrameRegistration after = registration->Register(Frame(elsewhere * Flight(1, 2, 0)));
  EXPECT_EQ(after.quality, RegistrationQuality::kValid);
  EXPECT_FALSE(after.starts_segment);
  EXPECT_LT(HomographyRms(after.previous_from_frame, Flight(1, 2, 0), kWidth, kHeight), 0.1);
}

TEST_P(StreamRegistrationTest, SaysWhatHappened) {
  const auto registration = Make();
  const auto change = [&](const Eigen::Matrix3d& ground_from_frame) {
    return registration->Register(Frame(ground_from_frame)).change;
  };
  EXPECT_EQ(change(Flight(0, 3, 0)), FrameChange::kSteady);
  EXPECT_EQ(change(Flight(1, 3, 0)), FrameChange::kSteady);
  EXPECT_EQ(change(Flight(2, 3, 0)), FrameChange::kSteady);

  const FrameRegistration repeated = registration->Register(frame_);
  EXPECT_EQ(repeated.change, FrameChange::kRepeated);
  EXPECT_EQ(repeated.quality, RegistrationQuality::kValid);
  EXPECT_TRUE(repeated.previous_from_frame.isIdentity(1e-12));
  EXPECT_EQ(change(Flight(3, 3, 0)), FrameChange::kSteady);

  Eigen::Matrix3d far_off = Flight(4, 3, 0);
  far_off(0, 2) += 0.2 * kWidth;
  const FrameRegistration jump = registration->Register(Frame(far_off));
  EXPECT_EQ(jump.change, FrameChange::kJump);
  EXPECT_EQ(jump.quality, RegistrationQuality::kValid);
  EXPECT_FALSE(jump.starts_segment);

  Eigen::Matrix3d elsewhere = Eigen::Matrix3d::Identity();
  elsewhere.topRightCorner<2, 1>() << 4000, 7000;
  EXPECT_EQ(change(elsewhere), FrameChange::kCut);
  EXPECT_EQ(change(elsewhere * Flight(1, 3, 0)), FrameChange::kSteady);
  for (int t = 0; t < 3; ++t) {
    EXPECT_EQ(registration->Register(Constant(0)).change, FrameChange::kNoTexture) << t;
  }
  EXPECT_EQ(change(elsewhere * Flight(2, 3, 0)), FrameChange::kCut);
  EXPECT_EQ(change(elsewhere * Flight(3, 3, 0)), FrameChange::kSteady);
}

TEST_P(StreamRegistrationTest, ResetForgetsButCountsOn) {
  const auto registration = Make();
  registration->Register(Frame(Flight(0, 2, 0)));
  registration->Reset();
  const FrameRegistration r = registration->Register(Frame(Flight(50, 2, 0)));
  EXPECT_TRUE(r.starts_segment);
  EXPECT_EQ(r.quality, RegistrationQuality::kValid);
  EXPECT_EQ(r.frame_number, 1);
}

TEST_P(StreamRegistrationTest, WrongSizesAreRefused) {
  const auto registration = Make();
  const GrayImage other = backend_->MakeImage<std::uint8_t>(kWidth + 1, kHeight);
  EXPECT_THROW(registration->Register(other), std::invalid_argument);
  try {
    StreamRegistration(backend_, 100, 200, options_);
    FAIL() << "no error";
  } catch (const OptionError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("100x200"));
    EXPECT_THAT(error.what(), testing::HasSubstr("at least 114x114"));
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, StreamRegistrationTest,
                         testing::Values(ReferenceMode::kAnchor, ReferenceMode::kCentre),
                         [](const auto& info) {
                           return info.param == ReferenceMode::kAnchor ? "Anchor" : "Centre";
                         });

TEST(StreamRegistrationAnchor, MovesOnWhenOverlapShrinks) {
  const auto backend = Backend::Create("cpu");
  StreamRegistration registration(backend, kWidth, kHeight, {});
  GrayImage frame = backend->MakeImage<std::uint8_t>(kWidth, kHeight);
  const SyntheticGround ground;
  std::uint64_t anchor = 0;
  int moves = 0;
  Eigen::Matrix3d ground_from_anchor = Flight(0, 8.0, 0.0);
  for (int t = 0; t < 25; ++t) {
    ground.Render(Flight(t, 8.0, 0.0), 1.0, t, frame);
    const FrameRegistration r = registration.Register(frame);
    ASSERT_EQ(r.quality, RegistrationQuality::kValid) << t;
    if (r.anchor_number != anchor) {
      EXPECT_EQ(r.anchor_number, t - 1);
      ground_from_anchor = Flight(t - 1, 8.0, 0.0);
      anchor = r.anchor_number;
      ++moves;
    }
    EXPECT_GT(r.overlap, 0.7);
    const Eigen::Matrix3d truth = ground_from_anchor.inverse() * Flight(t, 8.0, 0.0);
    EXPECT_LT(HomographyRms(*r.anchor_from_frame, truth, kWidth, kHeight), 0.1) << t;
  }
  EXPECT_GE(moves, 3);
}

TEST(StreamRegistrationAnchor, MovesOnWhenParallaxSpoilsTheAgreement) {
  const auto backend = Backend::Create("cpu");
  const RegistrationOptions options;
  StreamRegistration registration(backend, kWidth, kHeight, options);
  GrayImage frame = backend->MakeImage<std::uint8_t>(kWidth, kHeight);
  const SyntheticGround ground;
  // Roofs on a third of the ground move past it by a third of a pixel a frame.
  const SyntheticGround roofs(2);
  constexpr double kRoofPx = 70;
  constexpr double kParallaxPx = 0.33;
  const auto ground_from_frame = [](int t) { return Flight(t, 1.0, 0.0); };
  std::uint64_t anchor = 0;
  int moves = 0;
  for (int t = 0; t < 30; ++t) {
    ground.Render(ground_from_frame(t), 1.0, t, frame, [&](int x, int y, double v) {
      const Eigen::Vector2d seen = Project(ground_from_frame(t), {x, y});
      const int cell =
          static_cast<int>(seen.x() / kRoofPx + 100) + static_cast<int>(seen.y() / kRoofPx + 100);
      return cell % 3 == 0 ? roofs.At(seen.x() + kParallaxPx * t, seen.y()) : v;
    });
    const FrameRegistration r = registration.Register(frame);
    ASSERT_EQ(r.quality, RegistrationQuality::kValid) << t;
    if (r.anchor_number != anchor) ++moves;
    anchor = r.anchor_number;
    EXPECT_GT(r.overlap, options.min_overlap);
    const Eigen::Matrix3d truth =
        ground_from_frame(static_cast<int>(anchor)).inverse() * ground_from_frame(t);
    EXPECT_LT(HomographyRms(*r.anchor_from_frame, truth, kWidth, kHeight), 0.5) << t;
  }
  EXPECT_GE(moves, 2);
}

TEST(GlobalMotionTest, ConfirmsTheTrueMotionOnly) {
  const auto backend = Backend::Create("cpu");
  GlobalMotion motion(*backend, kWidth, kHeight);
  const SyntheticGround ground;
  GrayImage frame = backend->MakeImage<std::uint8_t>(kWidth, kHeight);
  const Eigen::Matrix3d truth = CameraMotion(kWidth, kHeight, 0.1, 1.05, 30, -12, 0);
  ground.Render(Eigen::Matrix3d::Identity(), 2.0, 1, frame);
  EXPECT_FALSE(motion.NextShift(frame));
  ground.Render(truth, 2.0, 2, frame);
  motion.NextShift(frame);
  const Eigen::Matrix3d frame_from_previous = InverseHomography(truth);
  EXPECT_TRUE(motion.Confirms(frame_from_previous));
  EXPECT_FALSE(motion.Confirms(Eigen::Matrix3d::Identity()));
  Eigen::Matrix3d aside = Eigen::Matrix3d::Identity();
  aside(0, 2) = 12.0;
  EXPECT_FALSE(motion.Confirms(aside * frame_from_previous));

  Eigen::Matrix3d elsewhere = Eigen::Matrix3d::Identity();
  elsewhere.topRightCorner<2, 1>() << 4000, 7000;
  ground.Render(elsewhere, 2.0, 3, frame);
  motion.NextShift(frame);
  for (const Eigen::Matrix3d& found : motion.SearchTurnsAndZooms()) {
    EXPECT_FALSE(motion.Confirms(found));
  }
}

// 134.7 x 101.1 px before rounding, 404.2 x 227.4 px of the large picture.
TEST(TileLayoutTest, ReachesFromBorderToBorder) {
  const TileLayout layout = UniformTileLayout(640, 480, 6, 6);
  EXPECT_EQ(layout.tile_width, 128);
  EXPECT_EQ(layout.tile_height, 64);
  ASSERT_EQ(layout.tiles.size(), 36);
  EXPECT_EQ(layout.tiles.front().x, 0);
  EXPECT_EQ(layout.tiles.back().x + layout.tile_width, 640);
  EXPECT_EQ(layout.tiles.back().y + layout.tile_height, 480);
  const TileLayout large = UniformTileLayout(1920, 1080, 6, 6);
  EXPECT_EQ(large.tile_width, 256);
  EXPECT_EQ(large.tile_height, 256);
}

TEST(TileLayoutTest, TheSecondLayerLiesBetweenTheFirst) {
  const TileLayout layout = UniformTileLayout(640, 480, 4, 4, 2);
  ASSERT_EQ(layout.tiles.size(), TileCount(4, 4, 2));
  ASSERT_EQ(layout.tiles.size(), 25U);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const TileOrigin& between = layout.tiles[16 + row * 3 + column];
      const TileOrigin& upper_left = layout.tiles[row * 4 + column];
      const TileOrigin& lower_right = layout.tiles[(row + 1) * 4 + column + 1];
      EXPECT_NEAR(between.x - upper_left.x, lower_right.x - between.x, 1);
      EXPECT_NEAR(between.y - upper_left.y, lower_right.y - between.y, 1);
    }
  }
}

}  // namespace
}  // namespace windhover
