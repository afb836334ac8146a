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
#include "gpu-kernels/phase_correlation/phase_correlation_tables.h"
#include "tests/gpu-kernels/operator_test.h"

namespace windhover {
namespace {

constexpr int kSide = 128;

struct Blur {
  double x = 0.0;
  double y = 0.0;
};

// Waves of all directions, longer ones stronger (as 1 / f): a texture that can be sampled anywhere,
// so that a sub-pixel shift is exact.
class Texture {
 public:
  // The blur is that of a motion by `blur` px while the shutter is open.
  Texture(std::mt19937& random, double contrast, const Blur& blur) {
    constexpr int kWaves = 200;
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int i = 0; i < kWaves; ++i) {
      const double frequency = kTurn * 0.008 * std::pow(0.45 / 0.008, uniform(random));
      const double angle = kTurn * uniform(random);
      const double x = frequency * std::cos(angle);
      const double y = frequency * std::sin(angle);
      const double turn = 0.5 * (x * blur.x + y * blur.y);
      const double left = turn == 0.0 ? 1.0 : std::sin(turn) / turn;
      waves_.push_back({x, y, kTurn * uniform(random), left * contrast / std::sqrt(kWaves / 2.0)});
    }
  }

  // Values about 0 of a tile whose ground has moved by (dx, dy); row-major.
  std::vector<double> Tile(double dx, double dy) const {
    std::vector<double> tile(kSide * kSide);
    for (const Wave& wave : waves_) {
      // Along a row each wave turns by the same angle from pixel to pixel.
      const std::complex<double> step = std::polar(1.0, wave.x);
      for (int y = 0; y < kSide; ++y) {
        std::complex<double> value =
            std::polar(std::abs(wave.amplitude), (wave.amplitude < 0 ? 0.5 * kTurn : 0.0) +
                                                     wave.phase + wave.y * (y - dy) - wave.x * dx);
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
    double x, y, phase, amplitude;
  };
  std::vector<Wave> waves_;
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
                   const Blur& blur = {}, bool whole_shifts = false) {
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
      const Texture texture(random_, contrast, blur);
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
  const Accuracy whole = Measure(30.0, 3.0, 0.0, 0.8F, {}, true);
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

// Motion blur at a slant leaves a long peak at a slant. Half a pixel must not read as none.
TEST_P(PhaseCorrelationAccuracyTest, MotionBlurAtASlant) {
  const Accuracy accuracy = Measure(30.0, 3.0, 2.0, 1.0F, {.x = 8.0, .y = -16.0});
  EXPECT_EQ(accuracy.valid, 20);
  EXPECT_LT(accuracy.mean_error_px, 0.1) << "a parabola along each axis: 0.2";
}

// Interpolated a fraction of a pixel aside, fine detail would be off by 0.02 to 0.05 px, one way in
// all tiles.
TEST_P(PhaseCorrelationAccuracyTest, PredictionsMayBeFractionsOfAPixel) {
  PhaseCorrelationSettings settings;
  settings.tiles = {{0, 0}};
  const auto correlation = backend().MakePhaseCorrelation(settings);
  const auto reference = correlation->MakeSpectra();
  const auto current = correlation->MakeSpectra();
  double sum = 0.0;
  constexpr int kTrials = 10;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Texture texture(random_, 30.0, {});
    correlation->Transform(Upload(Shot(texture, 0.0, 0.0, 1.0)), kIdentity3, *reference);
    correlation->Transform(Upload(Shot(texture, 2.3, -1.3, 1.0)), {1, 0, 2.3, 0, 1, -1.3, 0, 0, 1},
                           *current);
    TilePeak peak;
    correlation->Correlate(*reference, *current, {&peak, 1});
    ASSERT_TRUE(peak.valid);
    EXPECT_NEAR(peak.dx, 0.0, 0.04);
    sum += peak.dx;
  }
  EXPECT_NEAR(sum / kTrials, 0.0, 0.008);
}

TEST_P(PhaseCorrelationAccuracyTest, PureNoiseGivesNoPeak) {
  for (const double noise : {1.0, 5.0, 20.0}) {
    EXPECT_LE(Measure(0.0, 3.0, noise, 0.8F).valid, 1) << noise;
  }
}

WINDHOVER_TEST_ON_ALL_BACKENDS(PhaseCorrelationAccuracyTest);

TEST(TileWindowTest, WeightsAreWhatTheirNamesSay) {
  const auto weights = [](TileWindow window, float alpha) {
    PhaseCorrelationSettings settings;
    settings.tile_width = 64;
    settings.tiles = {{0, 0}};
    settings.window = window;
    settings.window_alpha = alpha;
    const std::vector<float> w = PhaseCorrelationTables(settings).window_x;
    EXPECT_EQ(w.size(), 64U);
    for (int i = 0; i < 32; ++i) EXPECT_NEAR(w[i], w[63 - i], 1e-6F);
    EXPECT_TRUE(std::is_sorted(w.begin(), w.begin() + 32));
    return w;
  };
  for (const float w : weights(TileWindow::kNone, 0.0F)) EXPECT_EQ(w, 1.0F);
  EXPECT_NEAR(weights(TileWindow::kBlackman, 0.16F)[31], 1.0F, 0.01F);
  EXPECT_LT(weights(TileWindow::kBlackman, 0.16F)[0], 1e-3F);
  EXPECT_NEAR(weights(TileWindow::kCosine, 0.0F)[15], std::numbers::sqrt2 / 2, 0.02F);
  // 16 px from the middle are two and a half standard deviations of a tenth of 64 px.
  EXPECT_NEAR(weights(TileWindow::kGaussian, 0.1F)[15], std::exp(-0.5 * 2.58 * 2.58), 0.005F);
  const std::vector<float> tukey = weights(TileWindow::kTukey, 0.5F);
  EXPECT_EQ(tukey[16], 1.0F);
  EXPECT_LT(tukey[14], 1.0F);
  EXPECT_LT(tukey[0], 0.01F);
}

TEST(MeasurePeakTest, FindsGaussiansOfAnyDirection) {
  PhaseCorrelationSettings settings;
  settings.tiles = {{0, 0}};
  const PhaseCorrelationTables tables(settings);
  const int radius = tables.peak_radius;
  const int side = 2 * radius + 1;
  for (const double degrees : {0.0, 25.0, 63.0, 90.0, 140.0}) {
    const double c = std::cos(degrees * std::numbers::pi / 180);
    const double s = std::sin(degrees * std::numbers::pi / 180);
    for (const auto& [dx, dy] : {std::pair{0.0, 0.0}, {0.3, -0.2}, {-0.45, 0.4}, {0.5, 0.5}}) {
      const auto surface = [&, dx = dx, dy = dy](int x, int y) {
        const double along = c * (x - dx) + s * (y - dy);
        const double across = -s * (x - dx) + c * (y - dy);
        return static_cast<float>(0.2 * std::exp(-along * along / 18 - across * across / 2));
      };
      PeakNeighbourhood peak;
      for (int y = -3; y <= 3; ++y) {
        for (int x = -3; x <= 3; ++x) {
          if (surface(x, y) > surface(peak.x, peak.y)) peak.x = x, peak.y = y;
        }
      }
      std::vector<float> samples;
      for (int y = -radius; y <= radius; ++y) {
        for (int x = -radius; x <= radius; ++x) samples.push_back(surface(peak.x + x, peak.y + y));
      }
      ASSERT_EQ(samples.size(), static_cast<std::size_t>(side) * side);
      peak.samples = samples;
      peak.mean_square_outside = 1e-8F;
      peak.x &= tables.tile_width - 1;
      peak.y &= tables.tile_height - 1;
      const TilePeak measured = MeasurePeak(tables, peak, 1.0F, 1.0F);
      EXPECT_NEAR(measured.dx, dx, 1e-4) << degrees;
      EXPECT_NEAR(measured.dy, dy, 1e-4) << degrees;
    }
  }
}

}  // namespace
}  // namespace windhover
