// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/warp/warp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/gpu-kernels/operator_test.h"

namespace windhover {
namespace {

// A sample in double precision: its grey level, not rounded, and how far inside the picture's
// border it lies, in px; outside that is negative.
struct Sample {
  double grey = 0.0;
  double inside_px = -1.0;
};

Sample ReferenceSample(const Picture& source, const Matrix3& h, int x, int y) {
  const double w = h[6] * x + h[7] * y + h[8];
  if (!(w > 0.0)) return {};
  const double u = (h[0] * x + h[1] * y + h[2]) / w;
  const double v = (h[3] * x + h[4] * y + h[5]) / w;
  Sample sample;
  sample.inside_px = std::min({u, v, source.width - 1 - u, source.height - 1 - v});
  const int left = static_cast<int>(std::floor(std::clamp(u, 0.0, source.width - 1.0)));
  const int top = static_cast<int>(std::floor(std::clamp(v, 0.0, source.height - 1.0)));
  const int right = std::min(left + 1, source.width - 1);
  const int bottom = std::min(top + 1, source.height - 1);
  const double fx = u - left;
  const double fy = v - top;
  sample.grey = (1 - fy) * ((1 - fx) * source.at(left, top) + fx * source.at(right, top)) +
                fy * ((1 - fx) * source.at(left, bottom) + fx * source.at(right, bottom));
  return sample;
}

class WarpTest : public OperatorTest {
 protected:
  Picture Run(const Picture& source, const Matrix3& matrix, PictureSize size,
              int extra_stride = 0) {
    const GrayImage image = Upload(source, extra_stride);
    GrayImage result = Make(size.width, size.height, extra_stride);
    warp_->Run(image, matrix, result);
    return Download(result);
  }

  // Grey levels are within rounding of the exact ones, and seen is what is inside, but for
  // coordinates within 0.002 px of the border, where single precision may decide either way.
  void ExpectReference(const Picture& source, const Matrix3& matrix, PictureSize size,
                       int extra_stride = 0) {
    const Picture actual = Run(source, matrix, size, extra_stride);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const Sample sample = ReferenceSample(source, matrix, x, y);
        const int grey = actual.at(x, y);
        const bool seen = grey != 0;
        const bool at_border = std::abs(sample.inside_px) < 0.002;
        if (!at_border) {
          ASSERT_EQ(seen, sample.inside_px > 0.0) << "at " << x << ", " << y;
        }
        if (seen) {
          ASSERT_NEAR(grey, std::max(sample.grey, 1.0), 0.5 + 0.15) << "at " << x << ", " << y;
        }
      }
    }
  }

  std::unique_ptr<Warp> warp_ = backend().MakeWarp();
};

// Black becomes 1, everything else stays.
Picture WithoutZeros(Picture picture) {
  for (auto& pixel : picture.pixels) pixel = std::max<std::uint8_t>(pixel, 1);
  return picture;
}

Matrix3 Similarity(double angle, double scale, double dx, double dy) {
  const double c = scale * std::cos(angle);
  const double s = scale * std::sin(angle);
  return {c, -s, dx, s, c, dy, 0, 0, 1};
}

TEST_P(WarpTest, IdentityKeepsEveryPixelUpToTheBorder) {
  for (const PictureSize size : kOddSizes) {
    const Picture source = RandomPicture(size, 1);
    EXPECT_TRUE(SamePicture(Run(source, kIdentity3, size), WithoutZeros(source)));
    EXPECT_TRUE(SamePicture(Run(source, kIdentity3, size, 64), WithoutZeros(source)));
  }
}

TEST_P(WarpTest, WholeShiftsMovePixelsExactly) {
  const Picture source = RandomPicture({65, 31}, 1, 1, 255);
  for (const auto& [dx, dy] : {std::pair{5, 0}, {0, -7}, {-64, 30}, {64, -30}, {65, 0}, {0, 31}}) {
    Picture expected(65, 31);
    for (int y = 0; y < 31; ++y) {
      for (int x = 0; x < 65; ++x) {
        if (source.Has(x + dx, y + dy)) expected.at(x, y) = source.at(x + dx, y + dy);
      }
    }
    const Matrix3 shift = {1, 0, double(dx), 0, 1, double(dy), 0, 0, 1};
    EXPECT_TRUE(SamePicture(Run(source, shift, {65, 31}), expected)) << dx << ", " << dy;
  }
}

TEST_P(WarpTest, EqualsReferenceOnOddSizesAndHomographies) {
  const std::vector<Matrix3> matrices = {Similarity(0.0, 1.0, 0.37, -0.61),
                                         Similarity(0.02, 1.02, -3.3, 2.2),
                                         Similarity(-0.7, 0.8, 100.5, 30.25),
                                         Similarity(3.1, 1.0, 640.3, 470.1),
                                         {1.01, 0.02, -3.3, -0.02, 1.01, 2.2, 1e-4, -2e-4, 1},
                                         {0.9, 0.1, 12.1, -0.05, 1.1, 4.9, 3e-4, 4e-4, 0.9},
                                         {0.013, 0, 0.2, 0, 0.011, 0.3, 0, 0, 1},
                                         {7.1, 0.3, 0.4, 0.2, 6.9, 0.6, 0, 0, 1}};
  for (const PictureSize size : kOddSizes) {
    const Picture source = RandomPicture(size, 3);
    for (const Matrix3& matrix : matrices) {
      ExpectReference(source, matrix, size);
      ExpectReference(source, matrix, {size.height, size.width}, 64);
    }
  }
}

TEST_P(WarpTest, EqualsReferenceOnExtremes) {
  const Matrix3 matrix = Similarity(0.1, 0.9, 3.3, 4.4);
  ExpectReference(ExtremePicture({641, 479}, 1), matrix, {641, 479});
  for (const int grey : {0, 1, 255}) {
    ExpectReference(ConstantPicture({64, 48}, grey), matrix, {100, 80});
  }
}

// The horizon crosses the picture: beyond it w is not positive, and nothing is seen.
TEST_P(WarpTest, SeesNothingBeyondTheHorizon) {
  const Picture source = RandomPicture({200, 100}, 1, 1, 255);
  const Matrix3 matrix = {1, 0, 0, 0, 1, 0, -0.0101, 0, 1};
  const Picture result = Run(source, matrix, {200, 100});
  for (int y = 0; y < 100; ++y) {
    for (int x = 99; x < 200; ++x) ASSERT_EQ(result.at(x, y), 0) << x << ", " << y;
  }
  const Matrix3 zero = {};
  EXPECT_EQ(Run(source, zero, {200, 100}), ConstantPicture({200, 100}, 0));
  const Matrix3 negative = {-1, 0, 0, 0, -1, 0, 0, 0, -1};
  EXPECT_EQ(Run(source, negative, {200, 100}), ConstantPicture({200, 100}, 0));
}

// A homography is one up to a positive factor, however large or small.
TEST_P(WarpTest, ScaleOfTheMatrixDoesNotMatter) {
  const Picture source = RandomPicture({65, 31}, 1);
  Matrix3 matrix = {1.01, 0.02, -3.3, -0.02, 1.01, 2.2, 1e-4, -2e-4, 1};
  for (const double scale : {1e-300, 1e-30, 1e-3, 7.0, 1e30, 1e300}) {
    Matrix3 scaled = matrix;
    for (double& element : scaled) element *= scale;
    ExpectReference(source, matrix, {65, 31});
    const Picture expected = Run(source, matrix, {65, 31});
    const Picture actual = Run(source, scaled, {65, 31});
    for (std::size_t i = 0; i < actual.pixels.size(); ++i) {
      ASSERT_NEAR(actual.pixels[i], expected.pixels[i], 1) << scale;
    }
  }
}

TEST_P(WarpTest, FarAwaySourceIsNotSeen) {
  const Picture source = RandomPicture({65, 31}, 1, 1, 255);
  for (const double far : {1e6, 1e12, 1e200}) {
    for (const double sign : {-1.0, 1.0}) {
      const Matrix3 shift = {1, 0, sign * far, 0, 1, 0, 0, 0, 1};
      EXPECT_EQ(Run(source, shift, {65, 31}), ConstantPicture({65, 31}, 0)) << sign * far;
    }
  }
}

TEST_P(WarpTest, TwinsAgree) {
  const PictureSize size = {641, 479};
  const Picture source = RandomPicture(size, 9);
  const Matrix3 matrix = {1.01, 0.02, -3.3, -0.02, 1.01, 2.2, 1e-5, -2e-5, 1};
  const Picture actual = Run(source, matrix, size);

  Backend& cpu = *BackendNamed("CpuTwin");
  GrayImage cpu_source = cpu.MakeImage<std::uint8_t>(size.width, size.height);
  {
    const auto mapped = cpu_source.Write();
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) mapped.at(x, y) = source.at(x, y);
    }
  }
  GrayImage cpu_result = cpu.MakeImage<std::uint8_t>(size.width, size.height);
  cpu.MakeWarp()->Run(cpu_source, matrix, cpu_result);
  const Picture expected = Download(cpu_result);
  int unlike = 0;
  for (std::size_t i = 0; i < actual.pixels.size(); ++i) {
    if ((actual.pixels[i] == 0) != (expected.pixels[i] == 0)) {
      ++unlike;
    } else {
      ASSERT_NEAR(actual.pixels[i], expected.pixels[i], 1);
    }
  }
  EXPECT_LE(unlike, size.width * size.height / 1000);
}

TEST_P(WarpTest, RefusesMatricesThatAreNotFiniteAndEmptyImages) {
  const GrayImage source = Upload(ConstantPicture({64, 48}, 1));
  GrayImage result = Make(64, 48);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    for (int i = 0; i < 9; ++i) {
      Matrix3 matrix = kIdentity3;
      matrix[i] = bad;
      EXPECT_THROW(warp_->Run(source, matrix, result), std::invalid_argument);
    }
  }
  GrayImage none;
  EXPECT_THROW(warp_->Run(source, kIdentity3, none), std::invalid_argument);
  EXPECT_THROW(warp_->Run(none, kIdentity3, result), std::invalid_argument);
  EXPECT_THROW(warp_->Run(result, kIdentity3, result), std::invalid_argument);
}

WINDHOVER_TEST_ON_ALL_LAYOUTS(WarpTest);

}  // namespace
}  // namespace windhover
