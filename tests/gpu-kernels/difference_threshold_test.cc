// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/difference_threshold/difference_threshold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/gpu-kernels/operator_test.h"

namespace windhover {
namespace {

// 255 where a pixel is a seed. `gain` must be a multiple of 1/64, so that all is exact.
Picture ReferenceSeeds(const Picture& frame, const Picture& background, int threshold,
                       double gain) {
  const auto half_difference = [&background](int ax, int ay, int bx, int by) {
    if (!background.Has(ax, ay) || !background.Has(bx, by)) return 0.0;
    const int a = background.at(ax, ay);
    const int b = background.at(bx, by);
    return a == 0 || b == 0 ? 0.0 : std::abs(a - b) / 2.0;
  };
  Picture seeds(frame.width, frame.height);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      const int f = frame.at(x, y);
      const int b = background.at(x, y);
      if (f == 0 || b == 0) continue;
      const double gradient =
          std::max(half_difference(x - 1, y, x + 1, y), half_difference(x, y - 1, x, y + 1));
      if (std::abs(f - b) > threshold + gain * gradient) seeds.at(x, y) = 255;
    }
  }
  return seeds;
}

class DifferenceThresholdTest : public OperatorTest {
 protected:
  void ExpectReference(const Picture& frame, const Picture& background, int threshold, float gain,
                       int extra_stride = 0) {
    SCOPED_TRACE(testing::Message() << "threshold " << threshold << ", gain " << gain);
    const GrayImage frame_image = Upload(frame, extra_stride);
    const GrayImage background_image = Upload(background, extra_stride);
    BitImage seeds = backend().MakeBitImage(frame.width, frame.height);
    threshold_->Run(frame_image, background_image, {threshold, gain}, seeds);

    const auto words = seeds.words.Read();
    Picture actual(frame.width, frame.height);
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < 32 * words.width(); ++x) {
        const bool bit = (words.at(x / 32, y) >> (x % 32) & 1) != 0;
        if (x < frame.width) {
          actual.at(x, y) = bit ? 255 : 0;
        } else {
          ASSERT_FALSE(bit) << "past the width at " << x << ", " << y;
        }
      }
    }
    EXPECT_TRUE(SamePicture(actual, ReferenceSeeds(frame, background, threshold, gain)));
  }

  std::unique_ptr<DifferenceThreshold> threshold_ = backend().MakeDifferenceThreshold();
};

TEST_P(DifferenceThresholdTest, EqualsReferenceOnOddSizes) {
  for (const PictureSize size : kOddSizes) {
    const Picture frame = RandomPicture(size, 1);
    const Picture background = RandomPicture(size, 2);
    const Picture near_frame = RandomPicture(size, 3, 118, 138);
    const Picture near_background = RandomPicture(size, 4, 118, 138);
    for (const float gain : {0.0F, 0.015625F, 0.5F, 1.25F, 4.0F}) {
      for (const int threshold : {1, 20, 254, 255}) {
        ExpectReference(frame, background, threshold, gain);
        ExpectReference(frame, background, threshold, gain, 64);
      }
      ExpectReference(near_frame, near_background, 3, gain);
      ExpectReference(near_frame, near_background, 10, gain);
    }
  }
}

TEST_P(DifferenceThresholdTest, EqualsReferenceOnExtremes) {
  for (const PictureSize size : {PictureSize{33, 17}, PictureSize{641, 479}}) {
    for (const float gain : {0.0F, 0.5F, 4.0F}) {
      ExpectReference(ExtremePicture(size, 1), ExtremePicture(size, 2), 20, gain);
      ExpectReference(RandomPicture(size, 3, 0, 3), RandomPicture(size, 4, 0, 3), 1, gain);
      ExpectReference(RandomPicture(size, 5, 254, 255), RandomPicture(size, 6, 1, 2), 252, gain);
      ExpectReference(ConstantPicture(size, 255), ConstantPicture(size, 1), 253, gain);
      ExpectReference(ConstantPicture(size, 0), ConstantPicture(size, 255), 1, gain);
    }
  }
}

// Every grey level against every other, at thresholds on both sides of the difference.
TEST_P(DifferenceThresholdTest, EqualsReferenceForAllPairsOfGreyLevels) {
  Picture frame(256, 256);
  Picture background(256, 256);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      frame.at(x, y) = static_cast<std::uint8_t>(x);
      background.at(x, y) = static_cast<std::uint8_t>(y);
    }
  }
  for (const int threshold : {1, 2, 100, 127, 128, 253}) {
    for (const float gain : {0.0F, 1.0F, 4.0F}) {
      ExpectReference(frame, background, threshold, gain);
      ExpectReference(background, frame, threshold, gain);
    }
  }
}

TEST_P(DifferenceThresholdTest, RefusesWrongSizesAndSettings) {
  const GrayImage frame = Upload(ConstantPicture({64, 48}, 1));
  const GrayImage other = Upload(ConstantPicture({63, 48}, 1));
  BitImage seeds = backend().MakeBitImage(64, 48);
  BitImage other_seeds = backend().MakeBitImage(63, 48);
  EXPECT_THROW(threshold_->Run(frame, other, {}, seeds), std::invalid_argument);
  EXPECT_THROW(threshold_->Run(frame, frame, {}, other_seeds), std::invalid_argument);
  EXPECT_THROW(threshold_->Run(frame, frame, {0, 0.0F}, seeds), std::invalid_argument);
  EXPECT_THROW(threshold_->Run(frame, frame, {256, 0.0F}, seeds), std::invalid_argument);
  EXPECT_THROW(threshold_->Run(frame, frame, {20, -0.1F}, seeds), std::invalid_argument);
  EXPECT_THROW(threshold_->Run(frame, frame, {20, 4.1F}, seeds), std::invalid_argument);
  EXPECT_THROW(threshold_->Run(frame, frame, {20, std::nanf("")}, seeds), std::invalid_argument);
  EXPECT_NO_THROW(threshold_->Run(frame, frame, {}, seeds));
}

WINDHOVER_TEST_ON_ALL_LAYOUTS(DifferenceThresholdTest);

}  // namespace
}  // namespace windhover
