// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "gpu-kernels/phase_correlation/fourier_transform_cpu.h"
#include "tests/gpu-kernels/operator_test.h"

namespace windhover {
namespace {

struct TransformCase {
  std::string name;
  std::unique_ptr<FourierTransform> (*make)(int width, int height);
};

void PrintTo(const TransformCase& transform, std::ostream* out) { *out << transform.name; }

class FourierTransformTest : public testing::TestWithParam<TransformCase> {
 protected:
  struct alignas(64) Line {
    float values[16];
  };
  // `count` floats at an address as the transforms ask for.
  class Floats {
   public:
    explicit Floats(std::size_t count) : lines_(count / 16 + 1) {}
    float* get() { return lines_.front().values; }
    float& operator[](std::size_t i) { return lines_[i / 16].values[i % 16]; }

   private:
    std::vector<Line> lines_;
  };

  static void FillWithNoise(Floats& samples, PictureSize size, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(-1.0F, 1.0F);
    for (int i = 0; i < size.width * size.height; ++i) samples[i] = value(random);
  }
};

// The definition, along rows and then along columns, in double precision.
std::vector<std::complex<double>> SumsByDefinition(float* samples, PictureSize size) {
  const int bins = size.width / 2 + 1;
  const auto root = [](int k, int count) {
    return std::polar(1.0, -2.0 * std::numbers::pi * (k % count) / count);
  };
  std::vector<std::complex<double>> rows(static_cast<std::size_t>(bins) * size.height);
  std::vector<std::complex<double>> all(rows.size());
  for (int y = 0; y < size.height; ++y) {
    for (int k = 0; k < bins; ++k) {
      for (int x = 0; x < size.width; ++x) {
        rows[y * bins + k] +=
            static_cast<double>(samples[y * size.width + x]) * root(k * x, size.width);
      }
    }
  }
  for (int l = 0; l < size.height; ++l) {
    for (int y = 0; y < size.height; ++y) {
      const std::complex<double> turn = root(l * y, size.height);
      for (int k = 0; k < bins; ++k) all[l * bins + k] += turn * rows[y * bins + k];
    }
  }
  return all;
}

constexpr PictureSize kSizes[] = {{2, 2}, {16, 16}, {4, 64}, {64, 2}, {128, 32}};

TEST_P(FourierTransformTest, ForwardIsTheSumOfItsDefinition) {
  for (const PictureSize& size : kSizes) {
    const int count = size.width * size.height;
    const int bins = (size.width / 2 + 1) * size.height;
    Floats samples(count);
    FillWithNoise(samples, size, 1);
    const std::vector<std::complex<double>> expected = SumsByDefinition(samples.get(), size);
    Floats spectrum(2 * bins);
    GetParam().make(size.width, size.height)->Forward(samples.get(), spectrum.get());
    const double tolerance = 1e-6 * std::sqrt(count);
    for (int i = 0; i < bins; ++i) {
      ASSERT_NEAR(spectrum[2 * i], expected[i].real(), tolerance) << size.width << ", bin " << i;
      ASSERT_NEAR(spectrum[2 * i + 1], expected[i].imag(), tolerance) << size.width << ", " << i;
    }
  }
}

TEST_P(FourierTransformTest, InverseUndoesForwardUpToTheNumberOfSamples) {
  for (const PictureSize& size : {PictureSize{16, 16}, {2, 64}, {64, 32}, {512, 512}}) {
    const int count = size.width * size.height;
    Floats samples(count);
    Floats back(count);
    Floats spectrum((size.width + 2) * size.height);
    FillWithNoise(samples, size, 2);
    const auto transform = GetParam().make(size.width, size.height);
    transform->Forward(samples.get(), spectrum.get());
    transform->Inverse(spectrum.get(), back.get());
    for (int i = 0; i < count; ++i) {
      ASSERT_NEAR(back[i] / static_cast<float>(count), samples[i], 2e-6) << size.width << ", " << i;
    }
  }
}

// A shift of the samples turns the phases: an oracle that no mistake in both directions can pass.
TEST_P(FourierTransformTest, AWaveHasOneBin) {
  constexpr PictureSize kSize = {32, 16};
  constexpr int kBins = kSize.width / 2 + 1;
  Floats samples(kSize.width * kSize.height);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const double phase =
          2.0 * std::numbers::pi * (5.0 * x / kSize.width - 3.0 * y / kSize.height);
      samples[y * kSize.width + x] = static_cast<float>(std::sin(phase));
    }
  }
  Floats spectrum(2 * kBins * kSize.height);
  GetParam().make(kSize.width, kSize.height)->Forward(samples.get(), spectrum.get());
  for (int l = 0; l < kSize.height; ++l) {
    for (int k = 0; k < kBins; ++k) {
      const bool is_wave = k == 5 && l == kSize.height - 3;
      const int i = 2 * (l * kBins + k);
      EXPECT_NEAR(spectrum[i], 0.0, 1e-4) << k << ", " << l;
      // sin = (e^i - e^-i) / 2i: half of the samples, a quarter turn back.
      EXPECT_NEAR(spectrum[i + 1], is_wave ? -0.5 * kSize.width * kSize.height : 0.0, 1e-4)
          << k << ", " << l;
    }
  }
}

TEST_P(FourierTransformTest, RefusesOtherSides) {
  for (const PictureSize& size : {PictureSize{0, 16}, {16, 1}, {24, 16}, {16, 1024}, {-16, 16}}) {
    EXPECT_THROW(GetParam().make(size.width, size.height), std::invalid_argument);
  }
}

INSTANTIATE_TEST_SUITE_P(Transforms, FourierTransformTest,
                         testing::Values(TransformCase{"Fastest", MakeFourierTransform},
                                         TransformCase{"Plain", MakePlainFourierTransform}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace windhover
