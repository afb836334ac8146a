// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "service/vision/gray_range.h"

namespace windhover {
namespace {

GrayRange RangeOf(const std::vector<int>& values) {
  GrayHistogram histogram;
  for (const int value : values) histogram.Add(static_cast<std::uint16_t>(value));
  return histogram.RobustRange();
}

std::vector<int> Ramp(int low, int high) {
  std::vector<int> values;
  for (int value = low; value <= high; ++value) values.push_back(value);
  return values;
}

TEST(GrayHistogram, LeavesOutOneInAThousandAtEachEnd) {
  const GrayRange range = RangeOf(Ramp(3000, 12999));
  EXPECT_EQ(range.low, 3010);
  EXPECT_EQ(range.high, 12989);
}

TEST(GrayHistogram, OneHotAndOneDeadPixelDoNotCount) {
  for (const int pixels : {100, 5000}) {
    std::vector<int> values = Ramp(7000, 7000 + pixels - 1);
    values.push_back(65535);
    values.push_back(0);
    const GrayRange range = RangeOf(values);
    EXPECT_GE(range.low, 7000) << pixels;
    EXPECT_LE(range.high, 7000 + pixels - 1) << pixels;
  }
}

TEST(GrayHistogram, ConstantPicturesHaveARangeAroundTheirValue) {
  for (const int value : {0, 1, 9000, 65535}) {
    for (const int pixels : {1, 2, 3, 5000}) {
      const GrayRange range = RangeOf(std::vector<int>(pixels, value));
      EXPECT_EQ(range.low, value - 16);
      EXPECT_EQ(range.high, value + 16);
    }
  }
}

TEST(GrayHistogram, EndsOfTheScaleAndClearing) {
  GrayHistogram histogram;
  EXPECT_EQ(histogram.RobustRange().high, 65535);
  for (int value = 0; value < 65536; ++value) histogram.Add(static_cast<std::uint16_t>(value));
  EXPECT_EQ(histogram.RobustRange().low, 65);
  EXPECT_EQ(histogram.RobustRange().high, 65470);
  histogram.Clear();
  histogram.Add(500);
  EXPECT_EQ(histogram.RobustRange().low, 484);
}

TEST(GrayTable, IsLinearRoundedAndClipped) {
  const auto table = std::make_unique<GrayTable>();
  FillTable({1000.0, 1510.0}, *table);
  EXPECT_EQ((*table)[0], 0);
  EXPECT_EQ((*table)[1000], 0);
  EXPECT_EQ((*table)[1002], 1);
  EXPECT_EQ((*table)[1255], 128);  // 127.5
  EXPECT_EQ((*table)[1510], 255);
  EXPECT_EQ((*table)[65535], 255);
  FillTable({-10.0, 245.0}, *table);
  EXPECT_EQ((*table)[0], 10);
}

TEST(StreamGrayRange, StandsStillWhileThePictureFits) {
  StreamGrayRange stream;
  EXPECT_FALSE(stream.Follow({4000.0, 5000.0}));
  EXPECT_EQ(stream.range().low, 3875.0);
  EXPECT_EQ(stream.range().high, 5125.0);
  for (int t = 0; t < 200; ++t) {
    const double flicker = 100.0 * std::sin(0.7 * t);
    EXPECT_FALSE(stream.Follow({4000.0 + flicker, 5000.0 + 0.5 * flicker}));
    EXPECT_EQ(stream.range().low, 3875.0);
    EXPECT_EQ(stream.range().high, 5125.0);
  }
}

// A sensor that warms up: after the drift all fits again, and no step was above a quarter level.
TEST(StreamGrayRange, FollowsADriftSlowly) {
  StreamGrayRange stream;
  stream.Follow({4000.0, 5000.0});
  for (int t = 0; t < 2000; ++t) {
    const double drift = std::min(600.0, 0.5 * t);
    const GrayRange before = stream.range();
    ASSERT_FALSE(stream.Follow({4000.0 + drift, 5000.0 + drift})) << t;
    const double level = (before.high - before.low) / 255.0;
    ASSERT_LE(std::abs(stream.range().low - before.low), 0.2501 * level) << t;
    ASSERT_LE(std::abs(stream.range().high - before.high), 0.2501 * level) << t;
  }
  EXPECT_NEAR(stream.range().high, 5600.0, 1e-6);
}

TEST(StreamGrayRange, JumpsOnceWhereThePictureNoLongerFits) {
  for (const GrayRange& next :
       {GrayRange{9000.0, 10000.0}, {1000.0, 2000.0}, {4400.0, 4500.0}, {100.0, 16000.0}}) {
    StreamGrayRange stream;
    stream.Follow({4000.0, 5000.0});
    EXPECT_TRUE(stream.Follow(next)) << next.low;
    EXPECT_LT(stream.range().low, next.low);
    EXPECT_GT(stream.range().high, next.high);
    EXPECT_FALSE(stream.Follow(next)) << next.low;
  }
}

TEST(StreamGrayRange, ConstantFramesDoNotJumpForEver) {
  StreamGrayRange stream;
  stream.Follow({4984.0, 5016.0});
  for (int t = 0; t < 5; ++t) EXPECT_FALSE(stream.Follow({4984.0, 5016.0}));
}

TEST(StreamGrayRange, AResetIsNoJump) {
  StreamGrayRange stream;
  stream.Follow({4000.0, 5000.0});
  stream.Reset();
  EXPECT_FALSE(stream.Follow({9000.0, 9500.0}));
  EXPECT_EQ(stream.range().low, 8937.5);
}

}  // namespace
}  // namespace windhover
