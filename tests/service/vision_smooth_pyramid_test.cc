// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "gpu-kernels/backend.h"
#include "service/vision/mask_pyramid.h"
#include "service/vision/smooth_pyramid.h"

namespace windhover {
namespace {

constexpr int kWidth = 61;
constexpr int kHeight = 46;
constexpr int kLevels = 3;

template <typename ValueAt>
GrayImage Paint(ValueAt value_at) {
  static const std::shared_ptr<Backend> backend = Backend::Create("cpu");
  GrayImage picture = backend->MakeImage<std::uint8_t>(kWidth, kHeight);
  const auto pixels = picture.Write();
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) pixels.at(x, y) = static_cast<std::uint8_t>(value_at(x, y));
  }
  return picture;
}

TEST(SmoothPyramid, HalvesSizesUpwards) {
  SmoothPyramid pyramid;
  pyramid.Build(Paint([](int, int) { return 255; }), kLevels);
  const int sizes[kLevels][2] = {{61, 46}, {31, 23}, {16, 12}};
  for (int i = 0; i < kLevels; ++i) {
    const FloatPicture& level = pyramid.level(i);
    EXPECT_EQ(level.width, sizes[i][0]);
    EXPECT_EQ(level.height, sizes[i][1]);
    for (const float value : level.values) ASSERT_FLOAT_EQ(value, 255.0F);
  }
}

// A plane stays as it is away from the border: pixel x of level l lies at 2^l x.
TEST(SmoothPyramid, KeepsPixelsInTheirPlaces) {
  SmoothPyramid pyramid;
  pyramid.Build(Paint([](int x, int y) { return 2 * x + 3 * y; }), kLevels);
  for (int i = 0; i < kLevels; ++i) {
    const FloatPicture& level = pyramid.level(i);
    for (int y = 4; y < level.height - 4; ++y) {
      for (int x = 4; x < level.width - 4; ++x) {
        ASSERT_FLOAT_EQ(level.row(y)[x], static_cast<float>((2 * x + 3 * y) << i));
      }
    }
  }
}

TEST(SmoothPyramid, SpreadsAPointByTheBinomialFilter) {
  SmoothPyramid pyramid;
  pyramid.Build(Paint([](int x, int y) { return x == 30 && y == 20 ? 128 : 0; }), 1);
  const float filter[] = {1, 4, 6, 4, 1};
  for (int j = 0; j < 5; ++j) {
    for (int i = 0; i < 5; ++i) {
      EXPECT_FLOAT_EQ(pyramid.level(0).row(18 + j)[28 + i], 0.5F * filter[i] * filter[j]);
    }
  }
  EXPECT_EQ(pyramid.level(0).row(20)[27], 0.0F);
}

// Where the mask's pyramid lets a pixel take part, the picture's has nothing of what was left out.
TEST(MaskPyramid, LeavesOutWhatTheFilterMixes) {
  const auto left_out = [](int x, int y) { return x > 40 || (x > 20 && x < 25 && y < 5); };
  const GrayImage mask = Paint([&](int x, int y) { return left_out(x, y) ? 0 : 7; });
  SmoothPyramid smooth;
  smooth.Build(Paint([&](int x, int y) { return left_out(x, y) ? 200 : 0; }), kLevels);
  MaskPyramid use;
  use.Build(&mask, kLevels);
  for (int i = 0; i < kLevels; ++i) {
    const FloatPicture& level = smooth.level(i);
    ASSERT_EQ(use.level(i).size(), level.values.size());
    for (std::size_t at = 0; at < level.values.size(); ++at) {
      ASSERT_EQ(use.level(i)[at] != 0, level.values[at] == 0.0F) << i << ' ' << at;
    }
  }
  use.Build(nullptr, kLevels);
  for (int i = 0; i < kLevels; ++i) EXPECT_TRUE(use.level(i).empty());
}

}  // namespace
}  // namespace windhover
