// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "gpu-kernels/backend.h"
#include "replay/format/format_error.h"
#include "replay/offline/product_registration.h"
#include "replay/scoring/ground_residual.h"
#include "replay/scoring/video_score.h"

namespace windhover::replay {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

// Grey values of the ground; each picture shows it from `left` on.
using Ground = std::function<double(double x, double y)>;

cv::Mat Picture(const Ground& ground, double left, double noise = 0, unsigned seed = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> grain(0, 1);
  cv::Mat picture(kHeight, kWidth, CV_8UC1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      picture.at<std::uint8_t>(y, x) =
          cv::saturate_cast<std::uint8_t>(ground(x + left, y) + noise * grain(random));
    }
  }
  return picture;
}

// Up by 4 a px over 40 px, level over 40 px, down again, level again.
double Roofs(double x, double) {
  const double along = std::fmod(x + 1600, 160);
  if (along < 40) return 40 + 4 * along;
  if (along < 80) return 200;
  if (along < 120) return 200 - 4 * (along - 80);
  return 40;
}

// Structure about 18 px large, in all directions alike.
double Fields(double x, double y) {
  constexpr int kDirections = 16;
  double sum = 128;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = std::numbers::pi * i / kDirections;
    sum += 10 * std::sin(0.35 * (std::cos(angle) * x + std::sin(angle) * y) + 2.4 * i * i);
  }
  return sum;
}

// a_from_b where b lies `shift` px to the right of a on the ground.
Eigen::Matrix3d Shift(double shift) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix(0, 2) = shift;
  return matrix;
}

TEST(GroundResidual, IsSteepnessTimesErrorByHand) {
  const cv::Mat a = Picture(Roofs, 0);
  const cv::Mat b = Picture(Roofs, 8);
  // The true warp leaves nothing; none at all 8 px of 4 grey levels; a warp 2 px short 8 levels.
  const auto right = MeasureGroundResidual(a, b, Shift(8));
  ASSERT_TRUE(right);
  EXPECT_NEAR(right->warped, 0, 1e-3);
  EXPECT_NEAR(right->unwarped, 32, 1e-3);
  EXPECT_NEAR(right->gradient, 4, 1e-3);
  EXPECT_EQ(right->noise, 0);
  EXPECT_NEAR(right->misplacement_px(), 0, 1e-3);
  const auto short_of_it = MeasureGroundResidual(a, b, Shift(6));
  EXPECT_NEAR(short_of_it->warped, 8, 1e-3);
  // All errors lie along the gradient here; they are taken to lie in all directions.
  EXPECT_NEAR(short_of_it->misplacement_px(), 2 * std::sqrt(2.0), 1e-2);
}

TEST(GroundResidual, TheScaleOfTheWarpDoesNotMatter) {
  const cv::Mat a = Picture(Roofs, 0);
  const cv::Mat b = Picture(Roofs, 8);
  for (const double scale : {-3.0, 1e-6}) {
    EXPECT_NEAR(MeasureGroundResidual(a, b, scale * Shift(8))->warped, 0, 1e-3) << scale;
  }
}

TEST(GroundResidual, ReachesTheNoiseWhereTheWarpIsRight) {
  const double sigma = 5;
  const cv::Mat a = Picture(Fields, 0, sigma, 1);
  const cv::Mat b = Picture(Fields, 8, sigma, 2);
  const auto residual = MeasureGroundResidual(a, b, Shift(8));
  ASSERT_TRUE(residual);
  // The median of |difference| of two such noises; smoothing by 1 px leaves 1 / (2 sqrt(pi)).
  const double expected = 0.6745 * std::sqrt(2.0) * sigma * 0.2821;
  EXPECT_NEAR(residual->noise, expected, 0.1 * expected);
  EXPECT_NEAR(residual->warped, expected, 0.1 * expected);
  EXPECT_GT(residual->unwarped, 4 * expected);
  EXPECT_LT(residual->misplacement_px(), 0.1);
}

TEST(GroundResidual, TellsHowFarOffTheWarpIs) {
  // Both directions, so that the error meets the gradient at all angles.
  const cv::Mat a = Picture(Fields, 0, 2, 1);
  const cv::Mat b = Picture(Fields, 8, 2, 2);
  for (const double error : {0.5, 1.0, 2.0}) {
    const auto residual = MeasureGroundResidual(a, b, Shift(8 + error));
    EXPECT_NEAR(residual->misplacement_px(), error, 0.2 * error) << error;
  }
}

TEST(GroundResidual, AChangeOfBrightnessIsTakenOut) {
  const cv::Mat a = Picture(Roofs, 0);
  const cv::Mat b = Picture([](double x, double y) { return Roofs(x, y) + 20; }, 8);
  EXPECT_NEAR(MeasureGroundResidual(a, b, Shift(8))->warped, 0, 1e-3);
}

TEST(GroundResidual, WhatMovesHasNoSay) {
  const cv::Mat a = Picture(Roofs, 0);
  cv::Mat b = Picture(Roofs, 8);
  b(cv::Rect(0, 0, kWidth, kHeight / 8)) = 255;
  EXPECT_NEAR(MeasureGroundResidual(a, b, Shift(8))->warped, 0, 1e-3);
}

TEST(GroundResidual, NeedsCommonGround) {
  const cv::Mat a = Picture(Roofs, 0);
  EXPECT_FALSE(MeasureGroundResidual(a, a, Shift(kWidth - 5)));
  EXPECT_FALSE(MeasureGroundResidual(a, a, Eigen::Matrix3d::Zero()));
  Eigen::Matrix3d flat = Eigen::Matrix3d::Identity();
  flat(0, 0) = 0;
  EXPECT_FALSE(MeasureGroundResidual(a, a, flat));
}

// A flight to the right by `step` px a frame.
class Flight : public FrameSource {
 public:
  Flight(int frames, double step) : frames_(frames), step_(step) {}

  cv::Mat Next() override {
    if (next_ == frames_) return {};
    const cv::Mat picture = Picture(Fields, step_ * next_++);
    cv::Mat colour;
    cv::merge(std::vector<cv::Mat>(3, picture), colour);
    return colour;
  }
  int frames() const override { return frames_; }
  bool knows_frames() const override { return true; }

 private:
  int frames_;
  double step_;
  int next_ = 0;
};

std::vector<Eigen::Matrix3d> Homographies(int frames, double step) {
  std::vector<Eigen::Matrix3d> matrices;
  for (int i = 0; i < frames; ++i) matrices.push_back(Shift(step * i) * (1 + i));
  return matrices;
}

void Ignore() {}

TEST(VideoScore, CyclesByHand) {
  // Each step is 0.5 px too long in the homographies; registered at once, it is right.
  Flight flight(9, 4);
  const PairRegister right = [](const cv::Mat&, const cv::Mat&) { return Shift(12); };
  VideoScoreOptions options;
  options.gap = 3;
  options.every = 2;
  int frames = 0;
  const VideoScore score =
      ScoreVideo(flight, "flight", Homographies(9, 4.5), options, right, [&] { ++frames; });
  EXPECT_EQ(frames, 9);
  EXPECT_EQ(score.consecutive.size(), 8U);
  // From frames 0, 2 and 4.
  ASSERT_EQ(score.cycles_px.size(), 3U);
  EXPECT_EQ(score.across_gap.size(), 3U);
  for (const auto& cycle : score.cycles_px) EXPECT_NEAR(cycle.value(), 1.5, 1e-9);
  EXPECT_EQ(score.unregistered, 0);
  const ResidualSummary near = SummaryOf(score.consecutive);
  const ResidualSummary far = SummaryOf(score.across_gap);
  EXPECT_EQ(near.warped.count, 8);
  EXPECT_EQ(near.without_common, 0);
  EXPECT_NEAR(near.misplacement_px.median.value(), 0.5, 0.1);
  EXPECT_NEAR(far.misplacement_px.median.value(), 1.5, 0.3);
}

TEST(VideoScore, PairsThatCannotBeRegisteredAreCounted) {
  Flight flight(5, 4);
  const PairRegister never = [](const cv::Mat&, const cv::Mat&) { return std::nullopt; };
  VideoScoreOptions options;
  options.gap = 2;
  options.every = 1;
  const VideoScore score = ScoreVideo(flight, "flight", Homographies(5, 4), options, never, Ignore);
  EXPECT_EQ(score.unregistered, 3);
  for (const auto& cycle : score.cycles_px) EXPECT_FALSE(cycle);
}

TEST(VideoScore, NumbersMustAgree) {
  const PairRegister right = [](const cv::Mat&, const cv::Mat&) { return Shift(40); };
  const auto score = [&](int frames, int homographies, bool from_start) {
    Flight flight(frames, 4);
    VideoScoreOptions options;
    options.from_start = from_start;
    return ScoreVideo(flight, "flight", Homographies(homographies, 4), options, right, Ignore);
  };
  EXPECT_EQ(score(3, 3, false).consecutive.size(), 2U);
  EXPECT_THROW(score(3, 4, false), FormatError);
  EXPECT_THROW(score(4, 3, false), FormatError);
  EXPECT_EQ(score(4, 3, true).consecutive.size(), 2U);
  EXPECT_THROW(score(3, 4, true), FormatError);
  Flight flight(3, 4);
  VideoScoreOptions none;
  none.gap = 0;
  EXPECT_THROW(ScoreVideo(flight, "flight", Homographies(3, 4), none, right, Ignore),
               std::invalid_argument);
}

// Anything but periodic.
cv::Mat Rough(double left, unsigned seed) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  struct Wave {
    double u, v, phase;
  };
  std::vector<Wave> waves;
  for (int i = 0; i < 60; ++i) {
    waves.push_back({uniform(random) - 0.5, uniform(random) - 0.5, 6.28 * uniform(random)});
  }
  return Picture(
      [&](double x, double y) {
        double sum = 128;
        for (const Wave& wave : waves) sum += 8 * std::sin(wave.u * x + wave.v * y + wave.phase);
        return sum;
      },
      left, 2, seed);
}

TEST(ProductRegistration, RegistersTwoPictures) {
  ProductRegistration registration(Backend::Create("cpu"), kWidth, kHeight, RegistrationOptions());
  for (const double shift : {6.0, -9.0}) {
    const auto found = RegisterPair(registration, Rough(0, 1), Rough(shift, 2));
    ASSERT_TRUE(found) << shift;
    EXPECT_LT((*found - Shift(shift)).norm(), 0.1) << shift << "\n" << *found;
  }
  // Nothing in common, nothing to see.
  EXPECT_FALSE(RegisterPair(registration, Rough(0, 1), cv::Mat::zeros(kHeight, kWidth, CV_8UC1)));
}

}  // namespace
}  // namespace windhover::replay
