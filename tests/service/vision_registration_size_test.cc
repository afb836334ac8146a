// SPDX-License-Identifier: Apache-2.0
// Registration of pictures of any size, which it either refuses or registers.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include "service/options/option.h"
#include "service/vision/registration.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

enum class Content { kBlack, kSaturated, kNoise, kExtremes };

class RegistrationSizeTest : public testing::TestWithParam<std::string> {
 protected:
  static GrayImage Make(Backend& backend, int width, int height, Content content, unsigned seed) {
    GrayImage image = backend.MakeImage<std::uint8_t>(width, height);
    std::mt19937 random(seed);
    const auto mapped = image.Write();
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto noise = static_cast<std::uint8_t>(random() % 256);
        mapped.at(x, y) = content == Content::kBlack       ? 0
                          : content == Content::kSaturated ? 255
                          : content == Content::kNoise     ? noise
                                                           : (noise < 128 ? 0 : 255);
      }
    }
    return image;
  }

  std::shared_ptr<Backend> backend_ = Backend::Create(GetParam() == "CpuTwin" ? "cpu" : "::");
};

void ExpectFinite(const FrameRegistration& registration) {
  EXPECT_TRUE(registration.previous_from_frame.allFinite());
  EXPECT_TRUE(registration.corner_covariance.allFinite());
  EXPECT_GE(registration.corner_covariance.diagonal().minCoeff(), 0.0);
  EXPECT_GT(std::abs(registration.previous_from_frame.determinant()), 0.0);
}

// Two by two tiles are the fewest that there are: they need 42 px.
TEST_P(RegistrationSizeTest, AnySizeIsRefusedOrSurvived) {
  RegistrationOptions options;
  options.tile_columns = 2;
  options.tile_rows = 2;
  int refused = 0;
  for (int width = 1; width <= 70; ++width) {
    const int height = 1 + 37 * width % 70;
    SCOPED_TRACE(testing::Message() << width << "x" << height);
    if (width < 42 || height < 42) {
      EXPECT_THROW(StreamRegistration(backend_, width, height, options), OptionError);
      ++refused;
      continue;
    }
    StreamRegistration registration(backend_, width, height, options);
    unsigned seed = width;
    for (const Content content :
         {Content::kNoise, Content::kNoise, Content::kBlack, Content::kBlack, Content::kExtremes,
          Content::kSaturated, Content::kSaturated, Content::kExtremes}) {
      ExpectFinite(registration.Register(Make(*backend_, width, height, content, ++seed)));
    }
  }
  EXPECT_GT(refused, 35);
  EXPECT_LT(refused, 65);
}

TEST_P(RegistrationSizeTest, ConstantPicturesAreLostAtAnySize) {
  RegistrationOptions options;
  options.tile_columns = 2;
  options.tile_rows = 3;
  for (int width = 42; width <= 70; width += 3) {
    for (const Content content : {Content::kBlack, Content::kSaturated}) {
      StreamRegistration registration(backend_, width, 131 - width, options);
      for (int t = 0; t < 2; ++t) {
        const FrameRegistration r =
            registration.Register(Make(*backend_, width, 131 - width, content, 0));
        ExpectFinite(r);
        EXPECT_EQ(r.quality, RegistrationQuality::kLost) << width;
      }
    }
  }
}

// What is seen from one place twice has not moved, and what is seen from two has, at odd sizes too.
TEST_P(RegistrationSizeTest, SmallAndOddSizesRegister) {
  RegistrationOptions options;
  options.tile_columns = 3;
  options.tile_rows = 3;
  const SyntheticGround ground;
  for (const auto& [width, height] : {std::pair{97, 83}, {131, 101}, {64, 129}, {151, 75}}) {
    SCOPED_TRACE(testing::Message() << width << "x" << height);
    StreamRegistration registration(backend_, width, height, options);
    GrayImage frame = backend_->MakeImage<std::uint8_t>(width, height);
    const Eigen::Matrix3d moved = CameraMotion(width, height, 0.002, 1.0, 1.3, -0.8);
    ground.Render(Eigen::Matrix3d::Identity(), 0.0, 1, frame);
    registration.Register(frame);
    const FrameRegistration still = registration.Register(frame);
    ASSERT_NE(still.quality, RegistrationQuality::kLost);
    EXPECT_LT(HomographyRms(still.previous_from_frame, Eigen::Matrix3d::Identity(), width, height),
              1e-2);
    ground.Render(moved, 0.0, 1, frame);
    const FrameRegistration r = registration.Register(frame);
    ASSERT_NE(r.quality, RegistrationQuality::kLost);
    EXPECT_LT(HomographyRms(r.previous_from_frame, moved, width, height), 0.3);
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, RegistrationSizeTest, testing::Values("CpuTwin", "OpenCl"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace windhover
