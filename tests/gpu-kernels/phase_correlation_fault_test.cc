// SPDX-License-Identifier: Apache-2.0
// Faults that implementations of phase correlation have had, OpenCV's among them, and pictures that
// bring them out.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <utility>
#include <vector>

#include "gpu-kernels/phase_correlation/phase_correlation_tables.h"
#include "tests/gpu-kernels/phase_correlation_scene.h"

namespace windhover {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// The sum of those waves that have a whole number of periods, `lowest` to `highest`, along each
// axis of a square picture, whose ground has moved by (dx, dy): most bins of its spectrum are
// empty.
Picture Waves(int side, int lowest, int highest, double dx, double dy) {
  std::vector<double> sums(static_cast<std::size_t>(side) * side);
  for (int k = -highest; k <= highest; ++k) {
    for (int l = lowest; l <= highest; ++l) {
      if (std::abs(k) < lowest) continue;
      const double phase = 1.7 * k * k + 2.9 * l * l + k * l;
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          sums[y * side + x] += std::cos(phase + kTurn * (k * (x - dx) + l * (y - dy)) / side);
        }
      }
    }
  }
  double largest = 0.0;
  for (const double sum : sums) largest = std::max(largest, std::abs(sum));
  Picture picture(side, side);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    picture.pixels[i] = static_cast<std::uint8_t>(std::lround(128.0 + 120.0 * sums[i] / largest));
  }
  return picture;
}

class PhaseCorrelationFaultTest : public PhaseCorrelationTest {};

TEST_P(PhaseCorrelationFaultTest, NothingIsNanAndNoTextureGivesNoPeak) {
  for (const PictureSize side : {PictureSize{16, 16}, {32, 64}, {128, 128}}) {
    const auto correlation = backend().MakePhaseCorrelation(
        Settings(side.width, side.height, SomeTiles(side.width, side.height)));
    for (const Pair& pair : AllPairs()) {
      SCOPED_TRACE(pair.name);
      const auto peaks =
          Correlate(*correlation, pair, [&](const Picture& picture) { return Upload(picture); });
      const bool textureless = pair.name == "black" || pair.name == "saturated" ||
                               pair.name == "constant to ground" || pair.name == "far away";
      for (const TilePeak& peak : peaks) {
        ExpectFinite(peak);
        EXPECT_FALSE(textureless && peak.valid);
      }
    }
  }
}

// OpenCV #29849: bins of magnitude 0 put the peak into a corner.
TEST_P(PhaseCorrelationFaultTest, EmptyBinsDoNotMoveThePeak) {
  for (const TileWindow window : {TileWindow::kNone, TileWindow::kBlackman}) {
    PhaseCorrelationSettings settings = Settings(64, 64, {{0, 0}});
    settings.window = window;
    const auto peaks = Run(settings, {"", Waves(64, 1, 9, 0, 0), Waves(64, 1, 9, 5, -3)});
    EXPECT_NEAR(peaks[0].dx, 5.0, 0.3) << static_cast<int>(window);
    EXPECT_NEAR(peaks[0].dy, -3.0, 0.3) << static_cast<int>(window);
  }
}

// The same at its extreme: stripes have one frequency, and say nothing of a shift along them.
TEST_P(PhaseCorrelationFaultTest, StripesDoNotClaimAShiftAlongThem) {
  const auto stripes = [](double dx) {
    Picture picture(128, 128);
    for (int i = 0; i < 128 * 128; ++i) {
      const double phase = kTurn * (i % 128 - dx) / 16;
      picture.pixels[i] = static_cast<std::uint8_t>(std::lround(128 + 100 * std::sin(phase)));
    }
    return picture;
  };
  for (const TileWindow window : {TileWindow::kNone, TileWindow::kBlackman}) {
    PhaseCorrelationSettings settings = Settings(128, 128, {{0, 0}});
    settings.window = window;
    const TilePeak peak = Run(settings, {"", stripes(0), stripes(3)})[0];
    ExpectFinite(peak);
    EXPECT_FALSE(peak.valid) << static_cast<int>(window);
  }
}

// OpenCV #25737: large pictures of large contrast overflow.
TEST_P(PhaseCorrelationFaultTest, LargestTilesOfLargestContrast) {
  constexpr PictureSize kSide = {512, 512};
  PhaseCorrelationSettings settings = Settings(512, 512, {{0, 0}});
  settings.window = TileWindow::kNone;
  Picture halves = ConstantPicture(kSide, 0);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 512; ++x) halves.at(x, y) = 255;
  }
  for (const float peak_sigma : {0.0F, 4.0F}) {
    settings.peak_sigma_px = peak_sigma;
    ExpectFinite(Run(settings, {"", halves, halves})[0]);
    const Picture extremes = ExtremePicture(kSide, 5);
    const TilePeak peak = Run(settings, {"", extremes, extremes})[0];
    ExpectFinite(peak);
    EXPECT_TRUE(peak.valid);
    EXPECT_NEAR(peak.dx, 0.0, 1e-3);
    EXPECT_NEAR(peak.dy, 0.0, 1e-3);
  }
}

// OpenCV #9158: 8 px were read from half a pixel where the peak's neighbours are negative, as those
// of a texture without low frequencies are.
TEST_P(PhaseCorrelationFaultTest, NegativeNeighboursDoNotThrowThePeakFar) {
  for (const double shift : {0.0, 0.25, 0.5, -0.5}) {
    const auto peaks = Run(Settings(64, 64, {{0, 0}}),
                           {"", Waves(64, 12, 24, 0, 0), Waves(64, 12, 24, shift, -shift)});
    EXPECT_NEAR(peaks[0].dx, shift, 0.1);
    EXPECT_NEAR(peaks[0].dy, -shift, 0.1);
  }
}

// OpenCV #18927: indices overran at some sizes. Under AddressSanitizer this is where ours would.
TEST_P(PhaseCorrelationFaultTest, AnyPictureSize) {
  const auto correlation =
      backend().MakePhaseCorrelation(Settings(64, 32, {{0, 0}, {-20, 15}, {40, 50}}));
  for (int width = 1; width <= 70; ++width) {
    // Each height comes once, and squares.
    for (const int height : {1 + 37 * width % 70, width}) {
      const PictureSize size = {width, height};
      SCOPED_TRACE(testing::Message() << width << "x" << height);
      const Picture noise = RandomPicture(size, width);
      for (const Pair& pair :
           {Pair{"black", ConstantPicture(size, 0), noise},
            Pair{"saturated", ConstantPicture(size, 255), noise},
            Pair{"saturated both", ConstantPicture(size, 255), ConstantPicture(size, 255)},
            Pair{"extremes", ExtremePicture(size, width), ExtremePicture(size, width + 100)},
            Pair{"noise", noise, RandomPicture(size, width + 1)},
            Pair{"the same noise", noise, noise}}) {
        const auto peaks =
            Correlate(*correlation, pair, [&](const Picture& picture) { return Upload(picture); });
        for (const TilePeak& peak : peaks) {
          ExpectFinite(peak);
          EXPECT_LE(std::abs(peak.dx), 33.0F) << pair.name;
          EXPECT_LE(std::abs(peak.dy), 17.0F) << pair.name;
          const bool no_texture = pair.name.starts_with("black") || pair.name.starts_with("sat");
          EXPECT_FALSE(peak.valid && no_texture) << pair.name << ", height " << peak.height;
          if (!peak.valid || pair.name != "the same noise") continue;
          EXPECT_NEAR(peak.dx, 0.0, 0.01);
          EXPECT_NEAR(peak.dy, 0.0, 0.01);
        }
      }
    }
  }
}

WINDHOVER_TEST_ON_ALL_BACKENDS(PhaseCorrelationFaultTest);

// What rounding leaves of a constant tile may have a shape, and so rise above its own noise.
TEST(MeasurePeakFaultTest, BelievesNoPeakOfRoundingErrors) {
  PhaseCorrelationSettings settings;
  settings.tiles = {{0, 0}};
  for (const float noise_sigma : {0.1F, 1.0F, 20.0F}) {
    settings.noise_sigma = noise_sigma;
    const PhaseCorrelationTables tables(settings);
    const int side = 2 * tables.peak_radius + 1;
    PeakNeighbourhood peak;
    std::vector<float> samples(static_cast<std::size_t>(side) * side, 0.0F);
    peak.samples = samples;
    for (const auto& [height_to_least, valid] : {std::pair{0.9F, false}, {1.1F, true}}) {
      float& highest = samples[tables.peak_radius * side + tables.peak_radius];
      highest = height_to_least * tables.min_height;
      peak.mean_square_outside = highest * highest / 1e4F;
      EXPECT_EQ(MeasurePeak(tables, peak, 1.0F, 1.0F).valid, valid) << noise_sigma;
    }
  }
}

// No fit is thrown far by what lies beside the peak.
TEST(MeasurePeakFaultTest, StaysBesideTheHighestSample) {
  PhaseCorrelationSettings settings;
  settings.tiles = {{0, 0}};
  const PhaseCorrelationTables tables(settings);
  const int side = 2 * tables.peak_radius + 1;
  const int middle = tables.peak_radius * side + tables.peak_radius;
  struct Case {
    float left, right;  // beside a highest sample of 1
    float dx;
  };
  for (const Case& c : {Case{-0.9F, -0.9F, 0.0F},
                        {-0.9F, 1.0F, 0.5F},
                        {1.0F, -0.9F, -0.5F},
                        {-1e6F, 0.9F, 0.5F},
                        {0.0F, 0.0F, 0.0F},
                        {1.0F, 1.0F, 0.0F}}) {
    std::vector<float> samples(static_cast<std::size_t>(side) * side, -0.5F);
    samples[middle] = 1.0F;
    samples[middle - 1] = c.left;
    samples[middle + 1] = c.right;
    PeakNeighbourhood peak;
    peak.samples = samples;
    peak.mean_square_outside = 1e-6F;
    const TilePeak measured = MeasurePeak(tables, peak, 1.0F, 1.0F);
    ExpectFinite(measured);
    EXPECT_NEAR(measured.dx, c.dx, 1e-3) << c.left << ", " << c.right;
    EXPECT_NEAR(measured.dy, 0.0, 1e-6);
  }
}

}  // namespace
}  // namespace windhover
