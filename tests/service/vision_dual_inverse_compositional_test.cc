// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>

#include "gpu-kernels/backend.h"
#include "service/vision/dual_inverse_compositional.h"
#include "service/vision/homography.h"
#include "tests/support/allocation_count.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth = 640;
constexpr int kHeight = 480;

GrayImage MakeImage(int width = kWidth, int height = kHeight) {
  static const std::shared_ptr<Backend> backend = Backend::Create("cpu");
  return backend->MakeImage<std::uint8_t>(width, height);
}

// What a camera with this pose, noise and photometry sees of the one ground. `paint` may put
// something else in front of it.
struct Camera {
  Eigen::Matrix3d ground_from_picture = Eigen::Matrix3d::Identity();
  double noise_sigma = 0.0;
  std::uint32_t seed = 1;
  GainBias reference_from_picture = {};
  std::function<double(int x, int y, double value)> paint = {};

  GrayImage Take(int width = kWidth, int height = kHeight) const {
    static const SyntheticGround ground(3);
    GrayImage picture = MakeImage(width, height);
    ground.Render(ground_from_picture, noise_sigma, seed, picture, [&](int x, int y, double value) {
      if (paint) value = paint(x, y, value);
      return Inverse(reference_from_picture)(value);
    });
    return picture;
  }
};

GrayImage Mask(const std::function<bool(int x, int y)>& takes_part) {
  GrayImage mask = MakeImage();
  const auto pixels = mask.Write();
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) pixels.at(x, y) = takes_part(x, y) ? 255 : 0;
  }
  return mask;
}

Eigen::Matrix3d Motion(double radians, double zoom, double dx, double dy, double perspective) {
  return CameraMotion(kWidth, kHeight, radians, zoom, dx, dy, perspective);
}

double CornerRms(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b, int width = kWidth,
                 int height = kHeight) {
  double sum = 0.0;
  for (const Eigen::Vector2d& corner : PictureCorners(width, height)) {
    sum += (Project(a, corner) - Project(b, corner)).squaredNorm();
  }
  return std::sqrt(sum / 4.0);
}

const Eigen::Matrix3d kMotions[] = {Eigen::Matrix3d::Identity(), Motion(0, 1, 0.5, 0.25, 0),
                                    Motion(0.02, 1.03, -14.3, 9.6, 0),
                                    Motion(-0.05, 0.96, 20.7, -12.2, 5e-5)};
const GainBias kPhotometries[] = {{1.0, 0.0}, {0.7, 20.0}, {1.4, -20.0}, {1.2, 15.0}};

TEST(DualInverseCompositional, Nominal) {
  DualInverseCompositional registration;
  registration.SetReference(Camera{}.Take());
  for (const Eigen::Matrix3d& truth : kMotions) {
    for (const GainBias& photometry : kPhotometries) {
      const GrayImage frame =
          Camera{.ground_from_picture = truth, .reference_from_picture = photometry}.Take();
      const DualRegistration result = registration.Register(frame);
      EXPECT_EQ(result.outcome, DualOutcome::kConverged);
      EXPECT_LT(CornerRms(result.reference_from_frame, truth), 0.02);
      EXPECT_DOUBLE_EQ(result.reference_from_frame(2, 2), 1.0);
      EXPECT_NEAR(result.photometry.gain, photometry.gain, 0.01 * photometry.gain);
      EXPECT_NEAR(result.photometry(128.0), photometry(128.0), 0.5);
      EXPECT_LT(result.residual, 1.5);
      EXPECT_GT(result.overlap, 0.8);
      EXPECT_GE(result.iterations, 1);
    }
  }
}

TEST(DualInverseCompositional, NoiseStability) {
  DualInverseCompositional registration;
  registration.SetReference(Camera{.noise_sigma = 5.0}.Take());
  for (const Eigen::Matrix3d& truth : kMotions) {
    for (const GainBias& photometry : kPhotometries) {
      const GrayImage frame = Camera{.ground_from_picture = truth,
                                     .noise_sigma = 5.0,
                                     .seed = 2,
                                     .reference_from_picture = photometry}
                                  .Take();
      const DualRegistration result = registration.Register(frame);
      EXPECT_TRUE(result.converged());
      EXPECT_LT(CornerRms(result.reference_from_frame, truth), 0.05);
      EXPECT_NEAR(result.photometry.gain, photometry.gain, 0.02 * photometry.gain);
      EXPECT_NEAR(result.photometry(128.0), photometry(128.0), 1.0);
    }
  }
}

// Odd sizes, pictures of one resolution only, and frames of another size than the reference.
TEST(DualInverseCompositional, NumericalStability) {
  const int sizes[][2] = {{32, 32}, {65, 47}, {333, 97}, {101, 411}, {1921, 61}};
  for (const auto& [width, height] : sizes) {
    const Eigen::Matrix3d truth = CameraMotion(width, height, 0.004, 1.005, 0.7, -0.4, 1e-6);
    DualInverseCompositional registration;
    registration.SetReference(Camera{}.Take(width, height));
    const DualRegistration result =
        registration.Register(Camera{.ground_from_picture = truth}.Take(width, height));
    EXPECT_TRUE(result.converged()) << width << 'x' << height;
    EXPECT_LT(CornerRms(result.reference_from_frame, truth, width, height), 0.1)
        << width << 'x' << height;
    const DualRegistration larger =
        registration.Register(Camera{.ground_from_picture = truth}.Take(width + 19, height + 40));
    EXPECT_TRUE(larger.converged()) << width << 'x' << height;
    EXPECT_LT(CornerRms(larger.reference_from_frame, truth, width, height), 0.1);
  }
}

TEST(DualInverseCompositional, OneReferenceServesManyFramesAlike) {
  const GrayImage reference = Camera{.noise_sigma = 2.0}.Take();
  DualInverseCompositional used;
  used.SetReference(Camera{.ground_from_picture = Motion(1, 1, 300, 90, 0)}.Take());
  used.SetReference(reference);
  DualInverseCompositional fresh;
  fresh.SetReference(reference);
  const GrayImage frame = Camera{kMotions[2], 2.0, 2}.Take();
  used.Register(Camera{kMotions[3], 2.0, 3}.Take());
  EXPECT_EQ(used.Register(frame).reference_from_frame, fresh.Register(frame).reference_from_frame);
}

TEST(DualInverseCompositional, AllocatesNothingOnceItIsWarm) {
  DualInverseCompositional registration;
  registration.SetReference(Camera{}.Take());
  const GrayImage frame = Camera{.ground_from_picture = kMotions[2]}.Take();
  registration.Register(frame);
  const std::size_t before = AllocationCount();
  registration.Register(frame);
  EXPECT_EQ(AllocationCount(), before);
}

TEST(DualInverseCompositional, GoesOnFromAStart) {
  // Half a picture away: out of reach from the identity.
  const Eigen::Matrix3d truth = Motion(0.3, 1.1, 190, -60, 2e-5);
  const Eigen::Matrix3d start = Motion(0.29, 1.09, 184, -64, 0);
  DualInverseCompositional registration;
  registration.SetReference(Camera{.noise_sigma = 2.0}.Take());
  const GrayImage frame = Camera{truth, 2.0, 2, {1.3, -10}}.Take();
  EXPECT_FALSE(registration.Register(frame).converged());
  const DualRegistration result = registration.Register(frame, start, {1.2, 0.0});
  EXPECT_TRUE(result.converged());
  EXPECT_LT(CornerRms(result.reference_from_frame, truth), 0.05);
  EXPECT_NEAR(result.photometry.gain, 1.3, 0.02);
  EXPECT_LT(result.overlap, 0.75);
}

// A homography is known up to a factor.
TEST(DualInverseCompositional, TakesAStartOfAnyScale) {
  DualInverseCompositional registration;
  registration.SetReference(Camera{}.Take());
  const GrayImage frame = Camera{.ground_from_picture = kMotions[2]}.Take();
  const DualRegistration result = registration.Register(frame, -3.0 * kMotions[1]);
  EXPECT_LT(CornerRms(result.reference_from_frame, kMotions[2]), 0.02);
}

// A fifth of the frame is covered by things that all move by the same 3 px, and that have a texture
// of their own. Plain least squares is drawn towards them.
TEST(DualInverseCompositional, MovingThingsDoNotDrawIt) {
  const SyntheticGround cargo(11);
  const auto thing = [&](double shift) {
    return [&cargo, shift](int x, int y, double value) {
      const double at = x - shift;
      const bool covered = std::fmod(at + 640.0, 160.0) < 64.0 && y % 120 < 60;
      return covered ? cargo.At(at, y) : value;
    };
  };
  DualInverseCompositional registration;
  registration.SetReference(Camera{.noise_sigma = 2.0, .paint = thing(0.0)}.Take());
  const Eigen::Matrix3d truth = Motion(0, 1, 1.5, -0.5, 0);
  const DualRegistration result =
      registration.Register(Camera{truth, 2.0, 2, {}, thing(3.0)}.Take());
  EXPECT_TRUE(result.converged());
  EXPECT_LT(CornerRms(result.reference_from_frame, truth), 0.1);
}

// What the mask leaves out of the reference may be anything, be it most of the picture.
TEST(DualInverseCompositional, TakesWhatTheMaskShows) {
  const auto on_ground = [](int x, int y) { return x >= 100 && x < 420 && y >= 60 && y < 330; };
  const auto cover = [&](int x, int y, double value) {
    return on_ground(x, y) ? value : 40.0 + 150.0 * ((x / 20 + y / 20) % 2);
  };
  const GrayImage mask = Mask(on_ground);
  const Eigen::Matrix3d truth = Motion(0.01, 1.01, 5.3, -3.1, 0);
  const GrayImage frame = Camera{truth, 2.0, 2}.Take();
  DualInverseCompositional registration;
  registration.SetReference(Camera{.noise_sigma = 2.0, .paint = cover}.Take(), &mask);
  const DualRegistration result = registration.Register(frame);
  EXPECT_TRUE(result.converged());
  EXPECT_LT(CornerRms(result.reference_from_frame, truth), 0.1);
  // The next reference has no mask.
  registration.SetReference(Camera{.noise_sigma = 2.0}.Take());
  EXPECT_LT(CornerRms(registration.Register(frame).reference_from_frame, truth), 0.05);
}

// A third of the frame is white: those pixels say nothing of gain, bias or place.
TEST(DualInverseCompositional, LeavesOutWhatIsClipped) {
  const Eigen::Matrix3d truth = kMotions[2];
  const GainBias photometry{0.5, 0.0};
  DualInverseCompositional registration;
  registration.SetReference(Camera{.noise_sigma = 1.0}.Take());
  const GrayImage frame = Camera{truth, 1.0, 2, photometry}.Take();
  {
    const auto pixels = frame.Read();
    int white = 0;
    for (int y = 0; y < kHeight; ++y)
      white += std::count(pixels.row(y), pixels.row(y) + kWidth, 255);
    ASSERT_GT(white, kWidth * kHeight / 3);
  }
  const DualRegistration result = registration.Register(frame);
  EXPECT_TRUE(result.converged());
  EXPECT_LT(CornerRms(result.reference_from_frame, truth), 0.05);
  EXPECT_NEAR(result.photometry.gain, photometry.gain, 0.01);
}

TEST(DualInverseCompositional, Degenerate) {
  DualInverseCompositional registration;
  const GrayImage frame = Camera{.noise_sigma = 2.0}.Take();
  const auto flat = [](int, int, double) { return 120.0; };
  const auto stripes = [](int x, int, double) { return 120.0 + 60.0 * std::sin(0.2 * x); };
  const auto outcome = [&](const GrayImage& picture) {
    const DualRegistration result = registration.Register(picture, kMotions[1], {1.1, 2.0});
    // What was not found is the start.
    EXPECT_TRUE(result.converged() || result.reference_from_frame == kMotions[1]);
    EXPECT_TRUE(result.converged() || result.photometry.gain == 1.1);
    return result.outcome;
  };
  registration.SetReference(Camera{.paint = flat}.Take());
  EXPECT_EQ(outcome(frame), DualOutcome::kNoTexture);
  registration.SetReference(Camera{.paint = stripes}.Take());
  EXPECT_EQ(outcome(Camera{.paint = stripes}.Take()), DualOutcome::kNoTexture);
  const GrayImage nothing = Mask([](int, int) { return false; });
  registration.SetReference(frame, &nothing);
  EXPECT_EQ(outcome(frame), DualOutcome::kLittleOverlap);

  registration.SetReference(Camera{.noise_sigma = 2.0}.Take());
  EXPECT_NE(outcome(Camera{.paint = flat}.Take()), DualOutcome::kConverged);
  EXPECT_NE(outcome(Camera{.noise_sigma = 4.0, .paint = flat}.Take()), DualOutcome::kConverged);
  EXPECT_NE(outcome(Camera{.reference_from_picture = {-1.0, 255.0}}.Take()),
            DualOutcome::kConverged);  // a negative
  for (const double elsewhere : {2000.0, 4000.0, 6000.0}) {
    EXPECT_NE(outcome(Camera{Motion(0, 1, elsewhere, 500, 0), 2.0, 2}.Take()),
              DualOutcome::kConverged);
  }
  const DualRegistration apart = registration.Register(frame, Motion(0, 1, 600, 0, 0));
  EXPECT_EQ(apart.outcome, DualOutcome::kLittleOverlap);
}

TEST(DualInverseCompositional, SaysWhenItHasNotConverged) {
  DualInverseCompositional registration({.most_iterations = 1});
  registration.SetReference(Camera{}.Take());
  const DualRegistration result =
      registration.Register(Camera{.ground_from_picture = kMotions[3]}.Take());
  EXPECT_EQ(result.outcome, DualOutcome::kNotConverged);
  EXPECT_FALSE(result.converged());
}

TEST(DualInverseCompositional, RefusesWhatIsNoPictureOrStart) {
  DualInverseCompositional registration;
  const GrayImage picture = Camera{}.Take();
  EXPECT_THROW(registration.Register(picture), std::logic_error);
  const GrayImage small = MakeImage(31, 40);
  EXPECT_THAT([&] { registration.SetReference(small); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("31x40")));
  EXPECT_THROW(registration.SetReference(Camera{}.Take(100, 100), &small), std::invalid_argument);
  registration.SetReference(picture);
  EXPECT_THROW(registration.Register(small), std::invalid_argument);
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d start = Eigen::Matrix3d::Zero();
  EXPECT_THROW(registration.Register(picture, start), std::invalid_argument);
  start = identity;
  start(0, 2) = std::nan("");
  EXPECT_THROW(registration.Register(picture, start), std::invalid_argument);
  EXPECT_THROW(registration.Register(picture, identity, {0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(
      registration.Register(picture, identity, {1.0, std::numeric_limits<double>::infinity()}),
      std::invalid_argument);
}

}  // namespace
}  // namespace windhover
