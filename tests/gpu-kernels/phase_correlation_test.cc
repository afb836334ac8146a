// SPDX-License-Identifier: Apache-2.0
// Contract of the phase correlation and agreement of its twins. How exactly shifts are measured is
// the subject of phase_correlation_accuracy_test.cc.

#include "gpu-kernels/phase_correlation/phase_correlation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <ostream>
#include <string>
#include <thread>
#include <vector>

#include "gpu-kernels/opencl/context.h"
#include "gpu-kernels/phase_correlation/phase_correlation_opencl.h"
#include "tests/gpu-kernels/operator_test.h"

namespace windhover {
namespace {

// Ground that can be looked at from anywhere: waves of many directions and lengths of 3 to 80 px.
double Ground(double x, double y) {
  double grey = 128.0;
  for (int i = 0; i < 40; ++i) {
    const double angle = 2.399963 * i;  // the golden angle spreads directions evenly
    const double frequency = 2.0 * 3.14159265 / (80.0 * std::pow(3.0 / 80.0, i / 39.0));
    grey += 11.0 * std::sin(frequency * (std::cos(angle) * x + std::sin(angle) * y) + i * i);
  }
  return grey;
}

// What a camera sees whose pixel x shows the ground at ground_from_picture(x).
Picture Shot(PictureSize size, const Matrix3& ground_from_picture) {
  Picture picture(size.width, size.height);
  const Matrix3& h = ground_from_picture;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double w = h[6] * x + h[7] * y + h[8];
      const double grey =
          Ground((h[0] * x + h[1] * y + h[2]) / w, (h[3] * x + h[4] * y + h[5]) / w);
      picture.at(x, y) = static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
    }
  }
  return picture;
}

Matrix3 Shift(double x, double y) { return {1, 0, x, 0, 1, y, 0, 0, 1}; }

// Turned by 3 degrees, 2 % larger, tilted: inverse of each other.
const Matrix3 kTurned = {1.0186, 0.0534, -14.0, -0.0534, 1.0186, 9.5, 1.2e-5, -2.1e-5, 1.0};

PhaseCorrelationSettings Settings(int tile_width, int tile_height, std::vector<TileOrigin> tiles) {
  PhaseCorrelationSettings settings;
  settings.tile_width = tile_width;
  settings.tile_height = tile_height;
  settings.tiles = std::move(tiles);
  return settings;
}

// 5 tiles, an odd number, of which the last ones hang out of a 333 x 251 picture.
std::vector<TileOrigin> SomeTiles(int width, int height) {
  return {{7, 5},
          {(333 - width) / 2, (251 - height) / 2},
          {333 - width - 3, 251 - height - 1},
          {-width / 3, 20},
          {333 - width / 2, 251 - height / 2}};
}

void ExpectFinite(const TilePeak& peak) {
  for (const float value : {peak.dx, peak.dy, peak.covariance_xx, peak.covariance_xy,
                            peak.covariance_yy, peak.height, peak.noise, peak.coverage}) {
    EXPECT_TRUE(std::isfinite(value));
  }
  EXPECT_GE(peak.covariance_xx, 0.0F);
  EXPECT_GE(peak.covariance_yy, 0.0F);
  EXPECT_GE(peak.coverage, 0.0F);
  EXPECT_LE(peak.coverage, 1.0F);
  EXPECT_GE(peak.noise, 0.0F);
}

// What the twins may differ by: offsets by half of what the contract allows; heights and noise by
// what samples that fall within rounding of the picture's border may make. Valid flags are compared
// but where a value lies at its threshold.
void ExpectTwins(const TilePeak& a, const TilePeak& b, const std::string& what) {
  SCOPED_TRACE(what);
  EXPECT_NEAR(a.coverage, b.coverage, 1e-3);
  EXPECT_NEAR(a.height, b.height, 1e-4 + 0.02 * std::abs(a.height));
  EXPECT_NEAR(a.noise, b.noise, 1e-4 + 0.05 * a.noise);
  const bool at_threshold = std::abs(a.height - 10.0F * a.noise) < 0.05F * a.height ||
                            std::abs(a.coverage - 0.25F) < 1e-3F;
  if (!at_threshold) {
    EXPECT_EQ(a.valid, b.valid);
  }
  if (!a.valid || !b.valid) return;
  EXPECT_NEAR(a.dx, b.dx, 0.01);
  EXPECT_NEAR(a.dy, b.dy, 0.01);
  const float scale = std::max(a.covariance_xx, a.covariance_yy);
  EXPECT_NEAR(a.covariance_xx, b.covariance_xx, 0.05 * scale);
  EXPECT_NEAR(a.covariance_xy, b.covariance_xy, 0.05 * scale);
  EXPECT_NEAR(a.covariance_yy, b.covariance_yy, 0.05 * scale);
}

// Reference and current picture, and where the current one is looked at.
struct Pair {
  std::string name;
  Picture reference;
  Picture current;
  Matrix3 current_from_grid = kIdentity3;
  // False where rounding decides what is seen, so that twins need not agree.
  bool well_conditioned = true;
};

template <typename MakeImage>
std::vector<TilePeak> Correlate(PhaseCorrelation& correlation, const Pair& pair,
                                const MakeImage& make_image) {
  const auto reference = correlation.MakeSpectra();
  const auto current = correlation.MakeSpectra();
  correlation.Transform(make_image(pair.reference), kIdentity3, *reference);
  correlation.Transform(make_image(pair.current), pair.current_from_grid, *current);
  std::vector<TilePeak> peaks(correlation.settings().tiles.size());
  correlation.Correlate(*reference, *current, peaks);
  return peaks;
}

std::vector<Pair> AllPairs() {
  constexpr PictureSize kSize = {333, 251};
  const Picture ground = Shot(kSize, kIdentity3);
  return {
      {"same", ground, ground},
      {"shifted", ground, Shot(kSize, Shift(-3.3, 1.7))},
      {"turned", ground, Shot(kSize, kTurned)},
      {"predicted", ground, ground, kTurned},
      {"mirrored about the horizon", ground, ground, {1, 0, 0, 0, 1, 0, 0.01, 0, -1}, false},
      {"far away", ground, ground, Shift(10000, -10000)},
      {"degenerate", ground, ground, {0, 0, 0, 0, 0, 0, 0, 0, 0}},
      {"black", ConstantPicture(kSize, 0), ConstantPicture(kSize, 0)},
      {"saturated", ConstantPicture(kSize, 255), ConstantPicture(kSize, 255)},
      {"constant to ground", ConstantPicture(kSize, 77), ground},
      {"noise", RandomPicture(kSize, 1), RandomPicture(kSize, 2)},
      {"same noise", RandomPicture(kSize, 1), RandomPicture(kSize, 1)},
      {"extremes", ExtremePicture(kSize, 1), ExtremePicture(kSize, 1)},
      {"other sizes", ground, Shot({97, 203}, kIdentity3)},
      {"one pixel", ground, ConstantPicture({1, 1}, 200)},
      {"one column", ground, Shot({1, 251}, kIdentity3)},
      {"one row", ground, Shot({333, 1}, kIdentity3)},
  };
}

class PhaseCorrelationTest : public OperatorTest {
 protected:
  std::vector<TilePeak> Run(const PhaseCorrelationSettings& settings, const Pair& pair,
                            int extra_stride = 0) {
    const auto correlation = backend().MakePhaseCorrelation(settings);
    return Correlate(*correlation, pair,
                     [&](const Picture& picture) { return Upload(picture, extra_stride); });
  }
};

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

TEST_P(PhaseCorrelationTest, SwappedPicturesShiftTheOtherWay) {
  const Picture a = Shot({333, 251}, kIdentity3);
  const Picture b = Shot({333, 251}, Shift(2.4, -5.1));
  const PhaseCorrelationSettings settings = Settings(128, 64, SomeTiles(128, 64));
  const auto forth = Run(settings, {"", a, b});
  const auto back = Run(settings, {"", b, a});
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(forth[i].valid && back[i].valid);
    EXPECT_NEAR(forth[i].dx, -back[i].dx, 1e-3);
    EXPECT_NEAR(forth[i].dy, -back[i].dy, 1e-3);
    EXPECT_NEAR(forth[i].height, back[i].height, 1e-3);
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

TEST_P(PhaseCorrelationTest, NothingIsNanAndNoTextureGivesNoPeak) {
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

// The twins on the same pictures, for an OpenCL layout and tile sides.
struct TwinCase {
  std::string name;
  PhaseCorrelationLayout layout;
  std::vector<PictureSize> sides;
};

void PrintTo(const TwinCase& twin_case, std::ostream* out) { *out << twin_case.name; }

class PhaseCorrelationTwinTest : public testing::TestWithParam<TwinCase> {};

TEST_P(PhaseCorrelationTwinTest, TwinsAgree) {
  const std::vector<opencl::Device> devices = opencl::ListDevices();
  ASSERT_FALSE(devices.empty()) << "this test needs an OpenCL device";
  const auto context = std::make_shared<opencl::Context>(
      devices.front(), opencl::ProgramCache(opencl::ProgramCache::DefaultFolder()));
  const auto cpu = BackendNamed("CpuTwin");
  const auto fill = [](GrayImage image, const Picture& picture) {
    const auto mapped = image.Write();
    for (int y = 0; y < picture.height; ++y) {
      std::copy_n(&picture.pixels[y * picture.width], picture.width, mapped.row(y));
    }
    return image;
  };
  const auto on_cpu = [&](const Picture& picture) {
    return fill(cpu->MakeImage<std::uint8_t>(picture.width, picture.height), picture);
  };
  const auto on_device = [&](const Picture& picture) {
    const int stride = (picture.width + 63) / 64 * 64;
    return fill(GrayImage(context->Allocate(stride * picture.height), picture.width, picture.height,
                          stride),
                picture);
  };
  const std::vector<Pair> pairs = AllPairs();
  for (const PictureSize side : GetParam().sides) {
    PhaseCorrelationSettings settings =
        Settings(side.width, side.height, SomeTiles(side.width, side.height));
    for (const float peak_sigma : {0.8F, 0.0F}) {
      settings.peak_sigma_px = peak_sigma;
      const auto cpu_twin = cpu->MakePhaseCorrelation(settings);
      const auto open_cl = MakePhaseCorrelationOpenCl(*context, settings, GetParam().layout);
      for (const Pair& pair : pairs) {
        if (!pair.well_conditioned) continue;
        const auto expected = Correlate(*cpu_twin, pair, on_cpu);
        const auto actual = Correlate(*open_cl, pair, on_device);
        for (std::size_t i = 0; i < expected.size(); ++i) {
          ExpectTwins(expected[i], actual[i],
                      pair.name + ", " + std::to_string(side.width) + "x" +
                          std::to_string(side.height) + ", tile " + std::to_string(i) + ", sigma " +
                          std::to_string(peak_sigma));
        }
      }
    }
  }
}

// As on CPUs with vectors of 16, 8 and 4, and as on GPUs.
INSTANTIATE_TEST_SUITE_P(
    Layouts, PhaseCorrelationTwinTest,
    testing::Values(
        TwinCase{
            "Lanes16Small",
            {.lanes = 16, .sample_rows = 8, .sample_batch = 64, .work_group = 1, .peak_group = 1},
            {{16, 16}, {32, 64}, {64, 32}}},
        TwinCase{
            "Lanes16Large",
            {.lanes = 16, .sample_rows = 8, .sample_batch = 64, .work_group = 1, .peak_group = 1},
            {{128, 128}, {256, 128}, {128, 256}, {512, 16}}},
        TwinCase{
            "Lanes8",
            {.lanes = 8, .sample_rows = 8, .sample_batch = 64, .work_group = 1, .peak_group = 1},
            {{64, 64}, {32, 64}}},
        TwinCase{
            "Lanes4",
            {.lanes = 4, .sample_rows = 16, .sample_batch = 16, .work_group = 4, .peak_group = 2},
            {{32, 32}, {32, 64}}},
        TwinCase{
            "Lanes2",
            {.lanes = 2, .sample_rows = 1, .sample_batch = 2, .work_group = 16, .peak_group = 32},
            {{32, 32}, {64, 32}}},
        TwinCase{"Lanes1", {}, {{64, 64}, {32, 64}}}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace windhover
