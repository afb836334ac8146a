// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <memory>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "gpu-kernels/backend.h"
#include "service/vision/feature_matching.h"
#include "service/vision/feature_registration.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

using testing::Optional;
using Failure = FeatureRegistrationFailure;

constexpr int kWidth = 480;
constexpr int kHeight = 360;

Backend& Cpu() {
  static const std::shared_ptr<Backend> backend = Backend::Create("cpu");
  return *backend;
}

struct View {
  Eigen::Matrix3d ground_from_frame = Eigen::Matrix3d::Identity();
  double gain = 1.0;
  double noise_sigma = 2.0;
  std::uint32_t seed = 1;
  int width = kWidth;
  int height = kHeight;
};

GrayImage Picture(const SyntheticGround& ground, const View& view) {
  GrayImage picture = Cpu().MakeImage<std::uint8_t>(view.width, view.height);
  ground.Render(view.ground_from_frame, view.noise_sigma, view.seed, picture,
                [&view](int, int, double v) { return view.gain * v; });
  return picture;
}

GrayImage Picture(const View& view) {
  static const SyntheticGround ground(3);
  return Picture(ground, view);
}

GrayImage Constant(int width, int height, std::uint8_t value) {
  GrayImage picture = Cpu().MakeImage<std::uint8_t>(width, height);
  const auto pixels = picture.Write();
  for (int y = 0; y < height; ++y) std::fill_n(pixels.row(y), width, value);
  return picture;
}

Eigen::Matrix3d Motion(double degrees, double zoom, double dx, double dy, double perspective = 0) {
  return CameraMotion(kWidth, kHeight, degrees * std::numbers::pi / 180, zoom, dx, dy, perspective);
}

double Rms(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return HomographyRms(a, b, kWidth, kHeight);
}

// Over the picture of which more lies on the other one: beyond that nothing was seen.
double RmsWhereSeen(const Eigen::Matrix3d& frame_from_reference,
                    const Eigen::Matrix3d& reference_from_frame) {
  return std::min(Rms(frame_from_reference, InverseHomography(reference_from_frame)),
                  Rms(InverseHomography(frame_from_reference), reference_from_frame));
}

FeatureRegistration Make(FeatureDetector detector,
                         RobustEstimator robust = RobustEstimator::kRansac) {
  FeatureRegistrationOptions options;
  options.detector = detector;
  options.robust = robust;
  return FeatureRegistration(options);
}

struct NamedDetector {
  std::string name;
  FeatureDetector detector;
  double rms_px;       // that it must reach with whatever motion
  double residual_px;  // likewise
};
void PrintTo(const NamedDetector& detector, std::ostream* out) { *out << detector.name; }

class FeatureDetectors : public testing::TestWithParam<NamedDetector> {};
INSTANTIATE_TEST_SUITE_P(All, FeatureDetectors,
                         testing::Values(NamedDetector{"sift", FeatureDetector::kSift, 0.1, 0.8},
                                         NamedDetector{"akaze", FeatureDetector::kAkaze, 0.2, 1.0},
                                         NamedDetector{"orb", FeatureDetector::kOrb, 0.3, 1.8}),
                         [](const auto& info) { return info.param.name; });

struct NamedMotion {
  const char* name;
  Eigen::Matrix3d reference_from_frame;
  double gain = 1.0;
  double noise_sigma = 2.0;
};

TEST_P(FeatureDetectors, FindKnownHomographies) {
  const FeatureRegistration registration = Make(GetParam().detector);
  const PictureFeatures reference = registration.Detect(Picture({}));
  const NamedMotion motions[] = {
      {"none", Motion(0, 1, 0, 0)},
      {"shift by a third", Motion(0, 1, 160.3, -45.7)},
      {"30 degrees", Motion(30, 1, 12, 8)},
      {"90 degrees", Motion(90, 1, 0, 0)},
      {"180 degrees", Motion(180, 1, 3.5, -2.25)},
      {"half the scale", Motion(0, 0.5, 0, 0)},
      {"twice the scale", Motion(-10, 2, 10, 5)},
      {"perspective", Motion(5, 1.1, -20, 10, 4e-4)},
      {"gain", Motion(3, 1, 15, 6), 0.6},
      {"noise", Motion(-3, 1, 15, 6), 1.0, 8.0},
  };
  std::uint32_t seed = 2;
  for (const NamedMotion& motion : motions) {
    const auto result = registration.Register(
        reference, registration.Detect(Picture({.ground_from_frame = motion.reference_from_frame,
                                                .gain = motion.gain,
                                                .noise_sigma = motion.noise_sigma,
                                                .seed = seed++})));
    EXPECT_EQ(result.failure, std::nullopt) << motion.name;
    // A corner of the reference that lies far outside of the frame may be known less well.
    if (result.overlap > 0.3) {
      EXPECT_EQ(result.quality, RegistrationQuality::kValid) << motion.name;
    }
    EXPECT_DOUBLE_EQ(result.frame_from_reference(2, 2), 1) << motion.name;
    EXPECT_LT(RmsWhereSeen(result.frame_from_reference, motion.reference_from_frame),
              GetParam().rms_px)
        << motion.name << ", " << result.inliers << " inliers of " << result.matches;
    EXPECT_LT(result.residual_px, GetParam().residual_px) << motion.name;
  }
}

TEST_P(FeatureDetectors, GiveTheSameToTheBit) {
  const FeatureRegistration registration = Make(GetParam().detector);
  const auto once = [&] {
    return registration.Register(
        registration.Detect(Picture({})),
        registration.Detect(Picture({.ground_from_frame = Motion(4, 1.05, 20, -7), .seed = 2})));
  };
  const FeatureRegistrationResult first = once();
  ASSERT_EQ(first.failure, std::nullopt);
  const int threads_before = cv::getNumThreads();
  for (const int threads : {1, 2, 3, 4}) {
    cv::setNumThreads(threads);
    const FeatureRegistrationResult again = once();
    cv::setNumThreads(threads_before);
    EXPECT_EQ(again.frame_from_reference, first.frame_from_reference);
    EXPECT_EQ(again.corner_covariance, first.corner_covariance);
    EXPECT_EQ(again.inliers, first.inliers);
  }
}

TEST_P(FeatureDetectors, RefuseUnrelatedPictures) {
  const FeatureRegistration registration = Make(GetParam().detector);
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto result =
        registration.Register(registration.Detect(Picture(SyntheticGround(seed), {})),
                              registration.Detect(Picture(SyntheticGround(seed + 100), {})));
    EXPECT_NE(result.failure, std::nullopt) << result.inliers << " of " << result.matches;
    EXPECT_EQ(result.quality, RegistrationQuality::kLost);
    EXPECT_EQ(result.frame_from_reference, Eigen::Matrix3d::Identity());
    EXPECT_TRUE(result.corner_covariance.isZero(0));
  }
}

TEST_P(FeatureDetectors, SayThatThereIsNoTexture) {
  const FeatureRegistration registration = Make(GetParam().detector);
  const PictureFeatures ground = registration.Detect(Picture({}));
  for (const std::uint8_t grey : {0, 90, 255}) {
    const PictureFeatures none = registration.Detect(Constant(kWidth, kHeight, grey));
    EXPECT_THAT(registration.Register(ground, none).failure, Optional(Failure::kNoTexture));
    EXPECT_THAT(registration.Register(none, ground).failure, Optional(Failure::kNoTexture));
    EXPECT_THAT(registration.Register(none, none).failure, Optional(Failure::kNoTexture));
  }
}

TEST_P(FeatureDetectors, TakePicturesOfAnySize) {
  const FeatureRegistration registration = Make(GetParam().detector);
  const PictureFeatures ground = registration.Detect(Picture({}));
  const int sizes[][2] = {{1, 1},   {2, 1},    {1, 500}, {15, 16}, {16, 16},
                          {17, 33}, {31, 400}, {63, 65}, {255, 97}};
  for (const auto& [width, height] : sizes) {
    const PictureFeatures features =
        registration.Detect(Picture({.width = width, .height = height}));
    EXPECT_EQ(features.width, width);
    EXPECT_EQ(features.height, height);
    for (const Eigen::Vector2d& x : features.x_in_picture) {
      EXPECT_TRUE(x.x() > -1 && x.y() > -1 && x.x() < width && x.y() < height) << x.transpose();
    }
    EXPECT_TRUE(registration.Register(ground, features).frame_from_reference.allFinite());
    EXPECT_TRUE(registration.Register(features, ground).frame_from_reference.allFinite());
    if (std::min(width, height) == 1) {
      EXPECT_EQ(features.size(), 0);
    }
  }
}

// A picture twice as large in one direction, of which the other is a part.
TEST_P(FeatureDetectors, RegisterPicturesOfDifferentSizes) {
  const FeatureRegistration registration = Make(GetParam().detector);
  const PictureFeatures large =
      registration.Detect(Picture({.width = 2 * kWidth, .height = kHeight}));
  const Eigen::Matrix3d truth = Motion(2, 1, 300.25, 4);
  const PictureFeatures small =
      registration.Detect(Picture({.ground_from_frame = truth, .seed = 2}));
  const auto in_small = registration.Register(large, small);
  EXPECT_LT(Rms(InverseHomography(in_small.frame_from_reference), truth), GetParam().rms_px);
  EXPECT_NEAR(in_small.overlap, 0.5, 0.05);
  const auto in_large = registration.Register(small, large);
  EXPECT_LT(Rms(in_large.frame_from_reference, truth), GetParam().rms_px);
  EXPECT_NEAR(in_large.overlap, 0.97, 0.05);
}

TEST_P(FeatureDetectors, SeeNothingUnderAMask) {
  FeatureRegistrationOptions options;
  options.detector = GetParam().detector;
  options.max_features = 100;  // of which a mask must cost none
  const FeatureRegistration registration(options);
  GrayImage mask = Constant(kWidth, kHeight, 0);
  {
    const auto pixels = mask.Write();
    for (int y = 100; y < 300; ++y) std::fill_n(pixels.row(y) + 150, 250, 255);
  }
  const PictureFeatures features = registration.Detect(Picture({}), &mask);
  EXPECT_EQ(features.size(), 100);
  for (const Eigen::Vector2d& x : features.x_in_picture) {
    EXPECT_TRUE(x.x() > 148 && x.x() < 401 && x.y() > 98 && x.y() < 301) << x.transpose();
  }
  const GrayImage dark = Constant(kWidth, kHeight, 0);
  EXPECT_EQ(registration.Detect(Picture({}), &dark).size(), 0);
  const GrayImage other_size = Constant(kWidth + 1, kHeight, 255);
  EXPECT_THROW(registration.Detect(Picture({}), &other_size), std::invalid_argument);
}

// Two thirds of the picture follow something else than the ground: with those masked away the
// ground is found, without it is not.
TEST(FeatureRegistrationTest, AMaskTakesAwayWhatIsNotGround) {
  const FeatureRegistration registration = Make(FeatureDetector::kSift);
  const SyntheticGround above(7);
  const auto picture = [&](const Eigen::Matrix3d& ground_from_frame, std::uint32_t seed) {
    GrayImage image = Cpu().MakeImage<std::uint8_t>(kWidth, kHeight);
    SyntheticGround(3).Render(ground_from_frame, 2, seed, image,
                              [&](int x, int y, double v) { return x < 320 ? above.At(x, y) : v; });
    return image;
  };
  GrayImage mask = Constant(kWidth, kHeight, 255);
  {
    const auto pixels = mask.Write();
    for (int y = 0; y < kHeight; ++y) std::fill_n(pixels.row(y), 320, 0);
  }
  const GrayImage first = picture(Eigen::Matrix3d::Identity(), 1);
  const GrayImage second = picture(Motion(0, 1, 12.5, -9.25), 2);
  const auto masked =
      registration.Register(registration.Detect(first, &mask), registration.Detect(second, &mask));
  EXPECT_EQ(masked.failure, std::nullopt);
  const Eigen::Vector2d x(400, 180);
  EXPECT_LT((Project(masked.frame_from_reference, x) - (x - Eigen::Vector2d(12.5, -9.25))).norm(),
            0.1);
  const auto all = registration.Register(registration.Detect(first), registration.Detect(second));
  EXPECT_LT((Project(all.frame_from_reference, x) - x).norm(), 1.0);
}

TEST(FeatureRegistrationTest, LeastMedianOfSquaresFindsTheSame) {
  const Eigen::Matrix3d truth = Motion(15, 0.9, -40, 22, 2e-4);
  const FeatureRegistration registration = Make(FeatureDetector::kSift, RobustEstimator::kLmeds);
  const auto result =
      registration.Register(registration.Detect(Picture({})),
                            registration.Detect(Picture({.ground_from_frame = truth, .seed = 2})));
  EXPECT_EQ(result.quality, RegistrationQuality::kValid);
  EXPECT_LT(Rms(InverseHomography(result.frame_from_reference), truth), 0.1);
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    EXPECT_NE(registration
                  .Register(registration.Detect(Picture(SyntheticGround(seed), {})),
                            registration.Detect(Picture(SyntheticGround(seed + 100), {})))
                  .failure,
              std::nullopt);
  }
}

// A mirrored picture is alike in all but geometry.
TEST(FeatureRegistrationTest, RefusesAMirroredPicture) {
  const FeatureRegistration registration = Make(FeatureDetector::kSift);
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
  mirror(0, 0) = -1;
  mirror(0, 2) = kWidth - 1;
  EXPECT_NE(registration
                .Register(registration.Detect(Picture({})),
                          registration.Detect(Picture({.ground_from_frame = mirror, .seed = 2})))
                .failure,
            std::nullopt);
}

// Features made by hand: `count` of one picture, each unlike all others, and the same ones in the
// other picture where `place` says.
template <typename Place>
FeatureRegistrationResult RegisterByHand(int count, Place&& place) {
  PictureFeatures reference;
  reference.width = kWidth;
  reference.height = kHeight;
  reference.descriptors = cv::Mat::zeros(count, count, CV_32F);
  for (int i = 0; i < count; ++i) {
    reference.x_in_picture.emplace_back(20 + 37 * (i % 11), 15 + 29 * (i / 11 % 11));
    reference.sigma_px.push_back(0.2);
    reference.descriptors.at<float>(i, i) = 100;
  }
  PictureFeatures frame = reference;
  for (int i = 0; i < count; ++i) frame.x_in_picture[i] = place(i, reference.x_in_picture[i]);
  return Make(FeatureDetector::kSift).Register(reference, frame);
}

TEST(FeatureRegistrationTest, NamesWhyItFailed) {
  const auto shifted = [](int, const Eigen::Vector2d& x) -> Eigen::Vector2d {
    return x + Eigen::Vector2d(7, 3);
  };
  EXPECT_EQ(RegisterByHand(60, shifted).failure, std::nullopt);
  EXPECT_THAT(RegisterByHand(7, shifted).failure, Optional(Failure::kNoTexture));
  EXPECT_THAT(RegisterByHand(60,
                             [](int i, const Eigen::Vector2d&) -> Eigen::Vector2d {
                               return {(i * 7919) % kWidth, (i * 104729) % kHeight};
                             })
                  .failure,
              Optional(Failure::kTooFewInliers));
  // Thirty times smaller: no detector finds its points again.
  EXPECT_THAT(RegisterByHand(60,
                             [](int, const Eigen::Vector2d& x) -> Eigen::Vector2d {
                               return 0.03 * x + Eigen::Vector2d(200, 200);
                             })
                  .failure,
              Optional(Failure::kImplausibleHomography));
  const FeatureRegistration registration = Make(FeatureDetector::kSift);
  PictureFeatures alike = registration.Detect(Picture({}));
  alike.descriptors = cv::Mat(alike.descriptors.size(), CV_32F, cv::Scalar(1));
  EXPECT_THAT(registration.Register(alike, alike).failure, Optional(Failure::kTooFewMatches));
  EXPECT_STREQ(NameOf(Failure::kTooFewMatches), "too few matches");
}

TEST(FeatureRegistrationTest, DoubtsAHomographyThatMostMatchesContradict) {
  const auto with_wrong = [](int right) {
    return RegisterByHand(110, [right](int i, const Eigen::Vector2d& x) -> Eigen::Vector2d {
      if (i % 11 < right) return x + Eigen::Vector2d(4, -6);
      return {(i * 7919) % kWidth, (i * 104729) % kHeight};
    });
  };
  EXPECT_EQ(with_wrong(9).quality, RegistrationQuality::kValid);
  EXPECT_EQ(with_wrong(9).inliers, 90);
  EXPECT_EQ(with_wrong(3).quality, RegistrationQuality::kDegraded);
  EXPECT_EQ(with_wrong(3).failure, std::nullopt);
}

TEST(FeatureRegistrationTest, KnowsHowExactItIs) {
  const FeatureRegistration registration = Make(FeatureDetector::kSift);
  constexpr int kTrials = 12;
  double normalised = 0;
  for (std::uint32_t i = 0; i < kTrials; ++i) {
    const SyntheticGround ground(i + 20);
    const Eigen::Matrix3d truth = Motion(i, 1 + 0.01 * i, 3.0 * i, -2.0 * i);
    const auto result = registration.Register(
        registration.Detect(Picture(ground, {.noise_sigma = 4})),
        registration.Detect(
            Picture(ground, {.ground_from_frame = truth, .noise_sigma = 4, .seed = 2})));
    ASSERT_EQ(result.failure, std::nullopt);
    Eigen::Matrix<double, 8, 1> error;
    const auto corners = PictureCorners(kWidth, kHeight);
    for (int c = 0; c < 4; ++c) {
      error.segment<2>(2 * c) = Project(result.frame_from_reference, corners[c]) -
                                Project(InverseHomography(truth), corners[c]);
    }
    normalised += error.dot(result.corner_covariance.ldlt().solve(error)) / 8;
  }
  EXPECT_GT(normalised / kTrials, 0.4);
  EXPECT_LT(normalised / kTrials, 2.5);
}

TEST(FeatureRegistrationTest, RefusesFeaturesOfTwoDetectors) {
  const PictureFeatures sift = Make(FeatureDetector::kSift).Detect(Picture({}));
  const PictureFeatures orb = Make(FeatureDetector::kOrb).Detect(Picture({}));
  EXPECT_THROW(Make(FeatureDetector::kSift).Register(sift, orb), std::invalid_argument);
}

TEST(FeatureRegistrationTest, RefusesOptionsOutOfRange) {
  FeatureRegistrationOptions options;
  options.match_ratio = 1.5;
  EXPECT_THROW(FeatureRegistration{options}, OptionError);
}

TEST(FeatureMatching, GuidedFindsWhatTheRatioTestHeldForAmbiguous) {
  const FeatureRegistration registration = Make(FeatureDetector::kSift);
  const Eigen::Matrix3d truth = Motion(3, 1, 15, 6);
  const PictureFeatures reference = registration.Detect(Picture({.noise_sigma = 8}));
  const PictureFeatures frame =
      registration.Detect(Picture({.ground_from_frame = truth, .noise_sigma = 8, .seed = 2}));
  const Eigen::Matrix3d frame_from_reference = InverseHomography(truth);
  const auto right = [&](const std::vector<FeatureMatch>& matches) {
    return std::count_if(matches.begin(), matches.end(), [&](const FeatureMatch& m) {
      return (Project(frame_from_reference, reference.x_in_picture[m.reference]) -
              frame.x_in_picture[m.frame])
                 .norm() < 1.5;
    });
  };
  const auto by_ratio = MatchByRatio(reference, frame, 0.8);
  const auto guided = MatchGuided(reference, frame, frame_from_reference, 3, 0.8, 300);
  EXPECT_GT(right(guided), 1.1 * static_cast<double>(right(by_ratio)));
  std::vector<bool> taken(frame.size());
  for (const FeatureMatch& match : guided) {
    EXPECT_FALSE(taken[match.frame]);
    taken[match.frame] = true;
    EXPECT_LE(match.distance, 300);
  }
}

}  // namespace
}  // namespace windhover
