// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/decimate/decimate.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/gpu-kernels/operator_test.h"

namespace windhover {
namespace {

Picture ReferenceDecimate(const Picture& source, int factor) {
  Picture result(source.width / factor, source.height / factor);
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      int sum = 0;
      for (int j = 0; j < factor; ++j) {
        for (int i = 0; i < factor; ++i) sum += source.at(factor * x + i, factor * y + j);
      }
      result.at(x, y) = static_cast<std::uint8_t>((sum + factor * factor / 2) / (factor * factor));
    }
  }
  return result;
}

class DecimateTest : public OperatorTest {
 protected:
  void ExpectReference(const Picture& source, int factor, int extra_stride = 0) {
    SCOPED_TRACE(testing::Message() << "factor " << factor);
    const Picture expected = ReferenceDecimate(source, factor);
    const GrayImage image = Upload(source, extra_stride);
    GrayImage result = Make(expected.width, expected.height, extra_stride);
    decimate_->Run(image, factor, result);
    EXPECT_TRUE(SamePicture(Download(result), expected));
  }

  std::unique_ptr<Decimate> decimate_ = backend().MakeDecimate();
};

TEST_P(DecimateTest, EqualsReferenceOnAllFactorsAndOddSizes) {
  for (const PictureSize size : kOddSizes) {
    for (int factor = 1; factor <= 16; ++factor) {
      if (size.width < factor || size.height < factor) continue;
      ExpectReference(RandomPicture(size, 1), factor);
      ExpectReference(ExtremePicture(size, 2), factor, 64);
    }
  }
}

// Sums on both sides of every rounding border.
TEST_P(DecimateTest, RoundsEveryMeanExactly) {
  for (const int factor : {2, 3, 7, 16}) {
    const int area = factor * factor;
    Picture source(factor * 256, factor * 3);
    for (int block = 0; block < 256; ++block) {
      for (int row = 0; row < 3; ++row) {
        // The mean is `block` and a fraction just under, at, or just over one half.
        const int extra = std::max(0, (area + 1) / 2 - 1 + row);
        for (int i = 0; i < area; ++i) {
          const int grey = block + (i < extra ? 1 : 0);
          source.at(block * factor + i % factor, row * factor + i / factor) =
              static_cast<std::uint8_t>(std::min(grey, 255));
        }
      }
    }
    ExpectReference(source, factor);
  }
}

TEST_P(DecimateTest, KeepsConstantPictures) {
  for (const int grey : {0, 1, 128, 255}) ExpectReference(ConstantPicture({640, 480}, grey), 16);
}

TEST_P(DecimateTest, RefusesWrongFactorsAndSizes) {
  const GrayImage source = Upload(ConstantPicture({64, 48}, 1));
  GrayImage half = Make(32, 24);
  EXPECT_THROW(decimate_->Run(source, 0, half), std::invalid_argument);
  EXPECT_THROW(decimate_->Run(source, 17, half), std::invalid_argument);
  EXPECT_THROW(decimate_->Run(source, 3, half), std::invalid_argument);
  GrayImage none;
  EXPECT_THROW(decimate_->Run(source, 2, none), std::invalid_argument);
  EXPECT_THROW(decimate_->Run(none, 2, half), std::invalid_argument);
  EXPECT_NO_THROW(decimate_->Run(source, 2, half));
}

WINDHOVER_TEST_ON_ALL_LAYOUTS(DecimateTest);

}  // namespace
}  // namespace windhover
