// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/stress_pairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "replay/baselines/klt_registration.h"
#include "replay/benchmarks/registration_results.h"
#include "tests/replay/benchmark_fixtures.h"

namespace windhover::replay {
namespace {

const cv::Size kCut(400, 300);

TEST(StressPairs, AreTrueToTheirHomography) {
  const cv::Mat ground = Ground(1);
  for (const Stress stress : kStresses) {
    const std::optional<StressPair> pair = CutStressPair(ground, kCut, stress, 0.2, 5);
    ASSERT_TRUE(pair) << NameOf(stress);
    EXPECT_EQ(pair->frame.size(), kCut);
    KltRegistration klt;
    klt.Register(pair->reference);
    const std::optional<Eigen::Matrix3d> found = klt.Register(pair->frame);
    ASSERT_TRUE(found) << NameOf(stress);
    if (stress == Stress::kCombined) continue;  // beyond KLT
    EXPECT_LT(*PairRms(found, *pair->reference_from_frame, kCut.width, kCut.height), 0.2)
        << NameOf(stress);
  }
}

// The singular values of the linear part are the scale, its angle the rotation.
TEST(StressPairs, GoToTheirLimits) {
  const cv::Mat ground = Ground(1);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto of = [&](Stress stress) {
      return CutStressPair(ground, kCut, stress, 1, seed)->reference_from_frame.value();
    };
    const Eigen::Vector3d middle(199.5, 149.5, 1);
    const Eigen::Matrix3d shift = of(Stress::kShift);
    EXPECT_NEAR((shift * middle - middle).norm(), 140, 1e-9);
    const Eigen::Matrix3d rotation = of(Stress::kRotation);
    EXPECT_NEAR(std::abs(std::atan2(rotation(1, 0), rotation(0, 0))), 10 * CV_PI / 180, 1e-9);
    EXPECT_NEAR(std::abs(of(Stress::kScale)(0, 0) - 1), 0.1, 1e-9);
    EXPECT_TRUE(of(Stress::kGain).isIdentity(1e-9));
    const std::optional<StressPair> gained = CutStressPair(ground, kCut, Stress::kGain, 1, seed);
    const double gain = cv::mean(gained->frame)[0] / cv::mean(gained->reference)[0];
    EXPECT_TRUE(std::abs(gain - 0.7) < 0.02 || std::abs(gain - 1.4) < 0.02) << gain;
    const std::optional<StressPair> noisy = CutStressPair(ground, kCut, Stress::kNoise, 1, seed);
    cv::Mat difference;
    cv::subtract(noisy->frame, noisy->reference, difference, cv::noArray(), CV_32F);
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(difference, mean, deviation);
    EXPECT_NEAR(deviation[0], 8 * std::sqrt(2.0), 0.3);
  }
}

TEST(StressPairs, RepeatFromTheirSeed) {
  const cv::Mat ground = Ground(1);
  const auto frame = [&](std::uint64_t seed) {
    return CutStressPair(ground, kCut, Stress::kCombined, 1, seed)->frame;
  };
  EXPECT_EQ(cv::norm(frame(3), frame(3), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(frame(3), frame(4), cv::NORM_INF), 0);
  EXPECT_NE(MixSeed(1, 2, 3), MixSeed(1, 3, 2));
  EXPECT_NE(MixSeed(1, 2, 3), MixSeed(2, 2, 3));
}

TEST(StressPairs, NeedRoom) {
  EXPECT_FALSE(CutStressPair(Ground(1), {600, 450}, Stress::kShift, 1, 1));
  EXPECT_TRUE(CutStressPair(Ground(1), {600, 450}, Stress::kGain, 1, 1));
}

TEST(FaultPairs, HaveTruthOnlyWhereThereIsSome) {
  const cv::Mat ground = Ground(1);
  const cv::Mat other = Ground(2);
  for (const Fault fault : kFaults) {
    const std::optional<StressPair> pair = CutFaultPair(ground, other, kCut, fault, 7);
    ASSERT_TRUE(pair) << NameOf(fault);
    EXPECT_EQ(pair->reference_from_frame.has_value(),
              fault == Fault::kBeyond || fault == Fault::kBlurred)
        << NameOf(fault);
  }
  EXPECT_LT(cv::mean(CutFaultPair(ground, other, kCut, Fault::kBlack, 7)->frame)[0], 3);
  const std::optional<StressPair> beyond = CutFaultPair(ground, other, kCut, Fault::kBeyond, 7);
  const double scale = std::sqrt(beyond->reference_from_frame->determinant());
  EXPECT_THAT(scale, testing::AllOf(testing::Gt(1 / 2.5), testing::Lt(1 / 1.6)));
}

TEST(MildPairs, RegisterUnderNoise) {
  const std::optional<StressPair> pair = CutMildPair(Ground(1), kCut, 5, 3);
  ASSERT_TRUE(pair);
  KltRegistration klt;
  klt.Register(pair->reference);
  EXPECT_LT(
      *PairRms(klt.Register(pair->frame), *pair->reference_from_frame, kCut.width, kCut.height),
      0.3);
}

}  // namespace
}  // namespace windhover::replay
