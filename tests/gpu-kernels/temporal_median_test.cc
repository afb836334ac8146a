// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/temporal_median/temporal_median.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/gpu-kernels/operator_test.h"

namespace windhover {
namespace {

Picture ReferenceMedian(const std::vector<Picture>& frames, int min_samples) {
  Picture result(frames[0].width, frames[0].height);
  for (std::size_t i = 0; i < result.pixels.size(); ++i) {
    std::vector<std::uint8_t> seen;
    for (const Picture& frame : frames) {
      if (frame.pixels[i] != 0) seen.push_back(frame.pixels[i]);
    }
    if (seen.empty() || static_cast<int>(seen.size()) < min_samples) continue;
    std::sort(seen.begin(), seen.end());
    result.pixels[i] = seen[(seen.size() - 1) / 2];
  }
  return result;
}

class TemporalMedianTest : public OperatorTest {
 protected:
  Picture Run(const std::vector<Picture>& frames, int min_samples, int extra_stride = 0) {
    std::vector<GrayImage> images;
    std::vector<const GrayImage*> pointers;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      // Frames of one window need not have one stride.
      images.push_back(Upload(frames[i], i % 2 == 0 ? extra_stride : 0));
    }
    for (const GrayImage& image : images) pointers.push_back(&image);
    GrayImage result = Make(frames[0].width, frames[0].height, extra_stride);
    median_->Run(pointers, min_samples, result);
    return Download(result);
  }

  void ExpectReference(const std::vector<Picture>& frames, int min_samples, int extra_stride = 0) {
    SCOPED_TRACE(testing::Message() << frames.size() << " frames, at least " << min_samples);
    EXPECT_TRUE(
        SamePicture(Run(frames, min_samples, extra_stride), ReferenceMedian(frames, min_samples)));
  }

  std::unique_ptr<TemporalMedian> median_ = backend().MakeTemporalMedian();
};

std::vector<Picture> Frames(PictureSize size, int count, int lowest, int highest) {
  std::vector<Picture> frames;
  for (int i = 0; i < count; ++i) frames.push_back(RandomPicture(size, 100 + i, lowest, highest));
  return frames;
}

TEST_P(TemporalMedianTest, EqualsReferenceOnOddSizes) {
  for (const PictureSize size : kOddSizes) {
    ExpectReference(Frames(size, 21, 1, 255), 1);
    ExpectReference(Frames(size, 21, 0, 255), 5, 64);
  }
}

TEST_P(TemporalMedianTest, EqualsReferenceForAllCountsOfFrames) {
  for (const int count : {1,  2,  3,  4,  5,  8,  11, 15,  16,  17,  20,  21,  22, 31,
                          32, 33, 41, 63, 64, 65, 81, 127, 128, 129, 200, 254, 255}) {
    ExpectReference(Frames({70, 5}, count, 0, 255), 1);
    ExpectReference(Frames({70, 5}, count, 0, 1), count / 2);
    ExpectReference(Frames({70, 5}, count, 0, 3), (count + 3) / 4);
    ExpectReference(Frames({70, 5}, count, 250, 255), count);
  }
}

TEST_P(TemporalMedianTest, OneOperatorServesAnyOrderOfCounts) {
  for (const int count : {21, 3, 255, 21, 1}) ExpectReference(Frames({33, 17}, count, 0, 255), 2);
}

TEST_P(TemporalMedianTest, EqualsReferenceOnExtremes) {
  std::vector<Picture> frames;
  for (int i = 0; i < 21; ++i) frames.push_back(ExtremePicture({641, 479}, i));
  ExpectReference(frames, 1);
  ExpectReference(frames, 11);
  ExpectReference(frames, 21);
  for (const int grey : {0, 1, 255}) {
    ExpectReference(std::vector<Picture>(255, ConstantPicture({33, 17}, grey)), 1);
  }
}

TEST_P(TemporalMedianTest, NeedsEnoughSamples) {
  const std::vector<Picture> frames(255, ConstantPicture({33, 17}, 7));
  EXPECT_EQ(Run(frames, 255), ConstantPicture({33, 17}, 7));
  EXPECT_EQ(Run(frames, 256), ConstantPicture({33, 17}, 0));
  EXPECT_EQ(Run(frames, 1000000), ConstantPicture({33, 17}, 0));
  EXPECT_EQ(Run(frames, 0), ConstantPicture({33, 17}, 7));
  EXPECT_EQ(Run(frames, -5), ConstantPicture({33, 17}, 7));
}

TEST_P(TemporalMedianTest, TakesTheLowerOfTwoMiddleValues) {
  const PictureSize size = {3, 2};
  const std::vector<Picture> frames = {ConstantPicture(size, 10), ConstantPicture(size, 200),
                                       ConstantPicture(size, 0)};
  EXPECT_EQ(Run(frames, 2), ConstantPicture(size, 10));
}

TEST_P(TemporalMedianTest, RefusesWrongSizesAndCounts) {
  const GrayImage frame = Upload(ConstantPicture({64, 48}, 1));
  const GrayImage other = Upload(ConstantPicture({64, 47}, 1));
  GrayImage result = Make(64, 48);
  const std::vector<const GrayImage*> none;
  const std::vector<const GrayImage*> unequal = {&frame, &other};
  const std::vector<const GrayImage*> null = {&frame, nullptr};
  const std::vector<const GrayImage*> too_many(256, &frame);
  EXPECT_THROW(median_->Run(none, 1, result), std::invalid_argument);
  EXPECT_THROW(median_->Run(unequal, 1, result), std::invalid_argument);
  EXPECT_THROW(median_->Run(null, 1, result), std::invalid_argument);
  EXPECT_THROW(median_->Run(too_many, 1, result), std::invalid_argument);
  GrayImage small = Make(63, 48);
  EXPECT_THROW(median_->Run(std::vector<const GrayImage*>{&frame}, 1, small),
               std::invalid_argument);
}

WINDHOVER_TEST_ON_ALL_LAYOUTS(TemporalMedianTest);

}  // namespace
}  // namespace windhover
