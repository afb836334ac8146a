// SPDX-License-Identifier: Apache-2.0
// Contract of the phase correlation. How exactly shifts are measured is the subject of
// phase_correlation_accuracy_test.cc.

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "tests/gpu-kernels/phase_correlation_scene.h"

namespace windhover {
namespace {

TEST_P(PhaseCorrelationTest, IdenticalPicturesDoNotShift) {
  const Picture ground = Shot({333, 251}, kIdentity3);
  for (const PictureSize side : {PictureSize{64, 64}, {128, 128}, {256, 128}}) {
    const auto peaks = Run(Settings(side.width, side.height, SomeTiles(side.width, side.height)),
                           {"", ground, ground});
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_TRUE(peaks[i].valid) << i;
      EXPECT_NEAR(peaks[i].dx, 0.0, 1e-3);
      EXPECT_NEAR(peaks[i].dy, 0.0, 1e-3);
      EXPECT_NEAR(peaks[i].coverage, 1.0, 1e-5);
    }
  }
}

// current(x + d) = reference(x): what the camera leaves to the left moves to the right. The window
// pulls large shifts towards 0 a little.
TEST_P(PhaseCorrelationTest, MeasuresKnownShiftsWithTheRightSign) {
  struct Case {
    double dx, dy, tolerance_px;
  };
  const Picture reference = Shot({333, 251}, kIdentity3);
  for (const Case& c : {Case{3.0, -2.0, 0.05}, Case{0.5, 0.25, 0.05}, Case{-7.3, 4.6, 0.1},
                        Case{12.0, 20.0, 0.25}}) {
    const Picture current = Shot({333, 251}, Shift(-c.dx, -c.dy));
    const auto peaks = Run(Settings(128, 128, SomeTiles(128, 128)), {"", reference, current});
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_TRUE(peaks[i].valid) << c.dx << ", " << c.dy;
      EXPECT_NEAR(peaks[i].dx, c.dx, c.tolerance_px);
      EXPECT_NEAR(peaks[i].dy, c.dy, c.tolerance_px);
    }
  }
}

TEST_P(PhaseCorrelationTest, EveryWindowMeasures) {
  const Picture reference = Shot({333, 251}, kIdentity3);
  const Picture current = Shot({333, 251}, Shift(-2.4, 1.3));
  for (const auto& [window, alpha] : {std::pair{TileWindow::kNone, 0.0F},
                                      {TileWindow::kBlackman, 0.0F},
                                      {TileWindow::kCosine, 0.0F},
                                      {TileWindow::kGaussian, 0.1F},
                                      {TileWindow::kTukey, 0.6F}}) {
    PhaseCorrelationSettings settings = Settings(128, 128, SomeTiles(128, 128));
    settings.window = window;
    settings.window_alpha = alpha;
    const auto peaks = Run(settings, {"", reference, current});
    // Without a window the border, which stays where it is, pulls towards 0.
    const double tolerance_px = window == TileWindow::kNone ? 1.0 : 0.1;
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_TRUE(peaks[i].valid) << static_cast<int>(window);
      EXPECT_NEAR(peaks[i].dx, 2.4, tolerance_px) << static_cast<int>(window);
      EXPECT_NEAR(peaks[i].dy, -1.3, tolerance_px) << static_cast<int>(window);
    }
  }
}

TEST_P(PhaseCorrelationTest, PredictionTakesAHomographyOff) {
  // The current picture's pixel p shows the grid's ground at kTurned(p); its inverse predicts.
  const Matrix3& t = kTurned;
  const Matrix3 inverse = {
      t[4] * t[8] - t[5] * t[7], t[2] * t[7] - t[1] * t[8], t[1] * t[5] - t[2] * t[4],
      t[5] * t[6] - t[3] * t[8], t[0] * t[8] - t[2] * t[6], t[2] * t[3] - t[0] * t[5],
      t[3] * t[7] - t[4] * t[6], t[1] * t[6] - t[0] * t[7], t[0] * t[4] - t[1] * t[3]};
  const auto peaks = Run(Settings(64, 64, {{40, 40}, {130, 90}, {220, 150}}),
                         {"", Shot({333, 251}, kIdentity3), Shot({333, 251}, kTurned), inverse});
  for (const TilePeak& peak : peaks) {
    EXPECT_TRUE(peak.valid);
    EXPECT_NEAR(peak.dx, 0.0, 0.05);
    EXPECT_NEAR(peak.dy, 0.0, 0.05);
  }
}

TEST_P(PhaseCorrelationTest, CoverageIsTheShareOfTheWindowInsideThePicture) {
  const Picture ground = Shot({333, 251}, kIdentity3);
  const auto peaks = Run(
      Settings(64, 64, {{100, 100}, {-32, 100}, {100, 251 - 32}, {-64, 0}, {-1000, 50}, {-50, 80}}),
      {"", ground, ground});
  EXPECT_NEAR(peaks[0].coverage, 1.0, 1e-5);
  EXPECT_NEAR(peaks[1].coverage, 0.5, 1e-3);
  EXPECT_NEAR(peaks[2].coverage, 0.5, 1e-3);
  EXPECT_EQ(peaks[3].coverage, 0.0F);
  EXPECT_EQ(peaks[4].coverage, 0.0F);
  EXPECT_LT(peaks[5].coverage, 0.25F);
  EXPECT_TRUE(peaks[0].valid);
  EXPECT_TRUE(peaks[1].valid);
  for (const std::size_t i : {3, 4, 5}) EXPECT_FALSE(peaks[i].valid);
}

TEST_P(PhaseCorrelationTest, StrideDoesNotMatter) {
  const Pair pair = {"", Shot({333, 251}, kIdentity3), Shot({333, 251}, Shift(1.5, 2.5))};
  const PhaseCorrelationSettings settings = Settings(64, 128, SomeTiles(64, 128));
  const auto narrow = Run(settings, pair);
  const auto wide = Run(settings, pair, 192);
  for (std::size_t i = 0; i < narrow.size(); ++i) {
    EXPECT_EQ(narrow[i].dx, wide[i].dx);
    EXPECT_EQ(narrow[i].dy, wide[i].dy);
    EXPECT_EQ(narrow[i].height, wide[i].height);
    EXPECT_EQ(narrow[i].valid, wide[i].valid);
  }
}

TEST_P(PhaseCorrelationTest, KeptSpectraServeManyPictures) {
  const auto correlation = backend().MakePhaseCorrelation(Settings(64, 64, {{20, 30}, {100, 60}}));
  const auto reference = correlation->MakeSpectra();
  const auto current = correlation->MakeSpectra();
  correlation->Transform(Upload(Shot({200, 150}, kIdentity3)), kIdentity3, *reference);
  std::vector<TilePeak> peaks(2);
  for (const double shift : {1.0, -3.0, 5.0}) {
    correlation->Transform(Upload(Shot({200, 150}, Shift(-shift, 0))), kIdentity3, *current);
    correlation->Correlate(*reference, *current, peaks);
    for (const TilePeak& peak : peaks) EXPECT_NEAR(peak.dx, shift, 0.15);
  }
}

TEST_P(PhaseCorrelationTest, SpectraThatWereNeverFilledGiveNoPeak) {
  const auto correlation = backend().MakePhaseCorrelation(Settings(32, 32, {{0, 0}}));
  const auto spectra = correlation->MakeSpectra();
  TilePeak peak;
  correlation->Correlate(*spectra, *spectra, {&peak, 1});
  ExpectFinite(peak);
  EXPECT_FALSE(peak.valid);
}

TEST_P(PhaseCorrelationTest, RefusesWhatTheContractRefuses) {
  const auto make = [&](auto change) {
    PhaseCorrelationSettings settings = Settings(32, 32, {{0, 0}});
    change(settings);
    return backend().MakePhaseCorrelation(settings);
  };
  using S = PhaseCorrelationSettings;
  EXPECT_NO_THROW(make([](S&) {}));
  EXPECT_THROW(make([](S& s) { s.tile_width = 8; }), std::invalid_argument);
  EXPECT_THROW(make([](S& s) { s.tile_height = 96; }), std::invalid_argument);
  EXPECT_THROW(make([](S& s) { s.tile_width = 1024; }), std::invalid_argument);
  EXPECT_THROW(make([](S& s) { s.tiles.clear(); }), std::invalid_argument);
  EXPECT_THROW(make([](S& s) { s.tiles.resize(1025); }), std::invalid_argument);
  EXPECT_THROW(make([](S& s) { s.window_alpha = 0.26F; }), std::invalid_argument);
  EXPECT_THROW(make([](S& s) { s.window = TileWindow::kGaussian, s.window_alpha = 0.0F; }),
               std::invalid_argument);
  EXPECT_THROW(make([](S& s) { s.window = TileWindow::kTukey, s.window_alpha = 1.1F; }),
               std::invalid_argument);
  EXPECT_THROW(make([](S& s) { s.peak_sigma_px = -1.0F; }), std::invalid_argument);
  EXPECT_THROW(make([](S& s) { s.noise_sigma = 0.0F; }), std::invalid_argument);
  EXPECT_THROW(make([](S& s) { s.noise_sigma = std::nanf(""); }), std::invalid_argument);

  const auto correlation = make([](S&) {});
  const auto spectra = correlation->MakeSpectra();
  const auto foreign = make([](S&) {})->MakeSpectra();
  const GrayImage picture = Upload(ConstantPicture({40, 40}, 9));
  std::vector<TilePeak> peaks(1);
  Matrix3 bad = kIdentity3;
  bad[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(correlation->Transform(picture, bad, *spectra), std::invalid_argument);
  EXPECT_THROW(correlation->Transform(GrayImage(), kIdentity3, *spectra), std::invalid_argument);
  EXPECT_THROW(correlation->Transform(picture, kIdentity3, *foreign), std::invalid_argument);
  EXPECT_THROW(correlation->Correlate(*spectra, *foreign, peaks), std::invalid_argument);
  EXPECT_THROW(correlation->Correlate(*foreign, *spectra, peaks), std::invalid_argument);
  peaks.resize(2);
  EXPECT_THROW(correlation->Correlate(*spectra, *spectra, peaks), std::invalid_argument);
}

TEST_P(PhaseCorrelationTest, OperatorsOfOneBackendRunSideBySide) {
  const Pair pair = {"", Shot({200, 150}, kIdentity3), Shot({200, 150}, Shift(1.5, 2.5))};
  const PhaseCorrelationSettings settings = Settings(64, 64, {{20, 30}, {100, 60}});
  const auto expected = Run(settings, pair);
  std::vector<std::thread> threads;
  std::atomic<int> equal = 0;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int round = 0; round < 5; ++round) {
        const auto peaks = Run(settings, pair);
        if (peaks[0].dx == expected[0].dx && peaks[1].dy == expected[1].dy) ++equal;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(equal, 20);
}

WINDHOVER_TEST_ON_ALL_BACKENDS(PhaseCorrelationTest);

}  // namespace
}  // namespace windhover
