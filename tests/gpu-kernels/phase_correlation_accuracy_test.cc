// SPDX-License-Identifier: Apache-2.0
// How exactly the phase correlation measures known shifts of synthetic ground.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

#include "gpu-kernels/phase_correlation/phase_correlation.h"
#include "tests/gpu-kernels/operator_test.h"

namespace windhover {
namespace {

constexpr int kSide = 128;

// Waves of all directions, longer ones stronger (as 1 / f): a texture that can be sampled anywhere,
// so that a sub-pixel shift is exact.
class Texture {
 public:
  Texture(std::mt19937& random, double contrast) {
    constexpr int kWaves = 200;
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int i = 0; i < kWaves; ++i) {
      const double frequency = kTurn * 0.008 * std::pow(0.45 / 0.008, uniform(random));
      const double angle = kTurn * uniform(random);
      waves_.push_back(
          {frequency * std::cos(angle), frequency * std::sin(angle), kTurn * uniform(random)});
    }
    amplitude_ = contrast / std::sqrt(kWaves / 2.0);
  }

  // Values about 0 of a tile whose ground has moved by (dx, dy); row-major.
  std::vector<double> Tile(double dx, double dy) const {
    std::vector<double> tile(kSide * kSide);
    for (const Wave& wave : waves_) {
      // Along a row each wave turns by the same angle from pixel to pixel.
      const std::complex<double> step = std::polar(1.0, wave.x);
      for (int y = 0; y < kSide; ++y) {
        std::complex<double> value =
            std::polar(amplitude_, wave.phase + wave.y * (y - dy) - wave.x * dx);
        for (int x = 0; x < kSide; ++x) {
          tile[y * kSide + x] += value.real();
          value = {value.real() * step.real() - value.imag() * step.imag(),
                   value.real() * step.imag() + value.imag() * step.real()};
        }
      }
    }
    return tile;
  }

 private:
  static constexpr double kTurn = 2.0 * std::numbers::pi;
  struct Wave {
    double x, y, phase;
  };
  std::vector<Wave> waves_;
  double amplitude_;
};

struct Accuracy {
  int valid = 0;
  double mean_error_px = 0.0;
  double max_error_px = 0.0;
  // RMS error over the root of the mean predicted variance.
  double error_to_prediction = 0.0;
};

class PhaseCorrelationAccuracyTest : public OperatorTest {
 protected:
  Picture Shot(const Texture& texture, double dx, double dy, double noise) {
    Picture picture(kSide, kSide);
    std::normal_distribution<double> gaussian(0.0, 1.0);
    const std::vector<double> tile = texture.Tile(dx, dy);
    for (int i = 0; i < kSide * kSide; ++i) {
      const double grey = 128.0 + tile[i] + noise * gaussian(random_);
      picture.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
    }
    return picture;
  }

  Accuracy Measure(double contrast, double max_shift, double noise, float peak_sigma,
                   bool whole_shifts = false) {
    constexpr int kTrials = 20;
    PhaseCorrelationSettings settings;
    settings.tiles = {{0, 0}};
    settings.peak_sigma_px = peak_sigma;
    settings.noise_sigma = static_cast<float>(std::max(noise, 1.0));
    const auto correlation = backend().MakePhaseCorrelation(settings);
    const auto reference = correlation->MakeSpectra();
    const auto current = correlation->MakeSpectra();
    std::uniform_real_distribution<double> shift(-max_shift, max_shift);
    Accuracy result;
    double square_sum = 0.0;
    double variance_sum = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
      const Texture texture(random_, contrast);
      double dx = shift(random_);
      double dy = shift(random_);
      if (whole_shifts) dx = std::round(dx), dy = std::round(dy);
      correlation->Transform(Upload(Shot(texture, 0.0, 0.0, noise)), kIdentity3, *reference);
      correlation->Transform(Upload(Shot(texture, dx, dy, noise)), kIdentity3, *current);
      TilePeak peak;
      correlation->Correlate(*reference, *current, {&peak, 1});
      result.valid += peak.valid ? 1 : 0;
      const double error = std::hypot(peak.dx - dx, peak.dy - dy);
      result.mean_error_px += error / kTrials;
      result.max_error_px = std::max(result.max_error_px, error);
      square_sum += error * error;
      variance_sum += peak.covariance_xx + peak.covariance_yy;
    }
    result.error_to_prediction = std::sqrt(square_sum / variance_sum);
    return result;
  }

  std::mt19937 random_{7};
};

TEST_P(PhaseCorrelationAccuracyTest, Nominal) {
  const Accuracy whole = Measure(30.0, 3.0, 0.0, 0.8F, true);
  EXPECT_EQ(whole.valid, 20);
  EXPECT_LT(whole.max_error_px, 0.1);
  const Accuracy accuracy = Measure(30.0, 3.0, 0.0, 0.8F);
  EXPECT_EQ(accuracy.valid, 20);
  EXPECT_LT(accuracy.mean_error_px, 0.05);
  EXPECT_LT(accuracy.max_error_px, 0.15);
}

TEST_P(PhaseCorrelationAccuracyTest, LargeShifts) {
  const Accuracy accuracy = Measure(30.0, 25.0, 2.0, 0.8F);
  EXPECT_EQ(accuracy.valid, 20);
  EXPECT_LT(accuracy.mean_error_px, 0.15);
}

TEST_P(PhaseCorrelationAccuracyTest, NoiseStability) {
  const Accuracy little = Measure(30.0, 3.0, 2.0, 0.8F);
  EXPECT_EQ(little.valid, 20);
  EXPECT_LT(little.mean_error_px, 0.05);
  const Accuracy more = Measure(30.0, 3.0, 5.0, 0.8F);
  EXPECT_EQ(more.valid, 20);
  EXPECT_LT(more.mean_error_px, 0.06);
  const Accuracy faint = Measure(8.0, 3.0, 5.0, 0.8F);
  EXPECT_EQ(faint.valid, 20);
  EXPECT_LT(faint.mean_error_px, 0.12);
}

// The covariances are those of the errors, within a factor of 2 of their root.
TEST_P(PhaseCorrelationAccuracyTest, CovarianceAgreesWithTheErrors) {
  for (const double noise : {0.0, 2.0, 5.0}) {
    const Accuracy accuracy = Measure(20.0, 3.0, noise, 0.8F);
    EXPECT_GT(accuracy.error_to_prediction, 0.5) << noise;
    EXPECT_LT(accuracy.error_to_prediction, 2.0) << noise;
  }
}

TEST_P(PhaseCorrelationAccuracyTest, GaussianPeakIsMoreExactThanADirac) {
  random_.seed(3);
  const Accuracy dirac = Measure(30.0, 3.0, 2.0, 0.0F);
  random_.seed(3);
  const Accuracy gaussian = Measure(30.0, 3.0, 2.0, 0.8F);
  EXPECT_LT(gaussian.mean_error_px, dirac.mean_error_px);
}

TEST_P(PhaseCorrelationAccuracyTest, PureNoiseGivesNoPeak) {
  for (const double noise : {1.0, 5.0, 20.0}) {
    EXPECT_LE(Measure(0.0, 3.0, noise, 0.8F).valid, 1) << noise;
  }
}

WINDHOVER_TEST_ON_ALL_BACKENDS(PhaseCorrelationAccuracyTest);

}  // namespace
}  // namespace windhover
