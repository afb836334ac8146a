// SPDX-License-Identifier: Apache-2.0
// What must hold of the phase correlation for any texture.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <utility>
#include <vector>

#include "tests/gpu-kernels/phase_correlation_scene.h"

namespace windhover {
namespace {

// What moves out at one side comes in at the other: without a window there is nothing that both
// pictures do not share. What lies at x lies at x + (dx, dy) then.
Picture Rolled(const Picture& picture, int dx, int dy) {
  Picture rolled(picture.width, picture.height);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      rolled.at((x + dx + picture.width) % picture.width,
                (y + dy + picture.height) % picture.height) = picture.at(x, y);
    }
  }
  return rolled;
}

PhaseCorrelationSettings WholePicture(PictureSize side) {
  PhaseCorrelationSettings settings = Settings(side.width, side.height, {{0, 0}});
  settings.window = TileWindow::kNone;
  return settings;
}

class PhaseCorrelationPropertyTest : public PhaseCorrelationTest {
 protected:
  // The ground as a shutter sees it that is open while the camera moves by `blur`, and the noise of
  // a sensor.
  Picture BlurredShot(PictureSize size, const Matrix3& ground_from_picture, double blur_x,
                      double blur_y) {
    constexpr int kSteps = 9;
    std::vector<double> sums(static_cast<std::size_t>(size.width) * size.height);
    for (int step = 0; step < kSteps; ++step) {
      const double share = static_cast<double>(step) / (kSteps - 1) - 0.5;
      Matrix3 moved = ground_from_picture;
      moved[2] += share * blur_x;
      moved[5] += share * blur_y;
      const Picture shot = Shot(size, moved);
      for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += shot.pixels[i];
    }
    std::normal_distribution<double> noise(0.0, 2.0);
    Picture picture(size.width, size.height);
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const auto grey = std::lround(sums[i] / kSteps + noise(random_));
      picture.pixels[i] = static_cast<std::uint8_t>(std::clamp(grey, 0L, 255L));
    }
    return picture;
  }

  TilePeak PeakOfBlurred(double blur_x, double blur_y) {
    constexpr PictureSize kSize = {128, 128};
    const Picture reference = BlurredShot(kSize, kIdentity3, blur_x, blur_y);
    const Picture current = BlurredShot(kSize, Shift(-1.4, 0.7), blur_x, blur_y);
    return Run(Settings(128, 128, {{0, 0}}), {"", reference, current})[0];
  }

  std::mt19937 random_{11};
};

TEST_P(PhaseCorrelationPropertyTest, CircularShiftsAreFoundExactly) {
  for (const PictureSize side : {PictureSize{16, 16}, {64, 64}, {32, 128}, {256, 16}}) {
    const Picture reference = RandomPicture(side, 3);
    const auto correlation = backend().MakePhaseCorrelation(WholePicture(side));
    const int far_x = side.width / 2 - 1;
    const int far_y = side.height / 2 - 1;
    for (const auto& [dx, dy] :
         {std::pair{0, 0}, {1, -1}, {-3, 5}, {far_x, far_y}, {-far_x, -far_y}, {far_x, 0}}) {
      const auto peaks = Correlate(*correlation, {"", reference, Rolled(reference, dx, dy)},
                                   [&](const Picture& picture) { return Upload(picture); });
      EXPECT_TRUE(peaks[0].valid) << side.width << ": " << dx << ", " << dy;
      EXPECT_NEAR(peaks[0].dx, dx, 1e-3) << side.width;
      EXPECT_NEAR(peaks[0].dy, dy, 1e-3) << side.width;
      EXPECT_NEAR(peaks[0].height, 1.0, 0.1) << side.width;
    }
  }
}

// Half a side to the left is half a side to the right.
TEST_P(PhaseCorrelationPropertyTest, AShiftOfHalfASideIsNotBelieved) {
  constexpr PictureSize kSide = {64, 32};
  const Picture reference = RandomPicture(kSide, 4);
  for (const auto& [dx, dy] : {std::pair{32, 0}, {0, 16}, {32, 16}}) {
    const auto peaks = Run(WholePicture(kSide), {"", reference, Rolled(reference, dx, dy)});
    EXPECT_FALSE(peaks[0].valid) << dx << ", " << dy;
    ExpectFinite(peaks[0]);
    EXPECT_NEAR(std::abs(peaks[0].dx), dx, 1e-3);
    EXPECT_NEAR(std::abs(peaks[0].dy), dy, 1e-3);
  }
}

TEST_P(PhaseCorrelationPropertyTest, SwappedPicturesShiftTheOtherWay) {
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

// The zero frequency says how bright a tile is, not where it lies.
TEST_P(PhaseCorrelationPropertyTest, BrightnessHasNoSay) {
  Picture reference = Shot({160, 160}, kIdentity3);
  Picture current = Shot({160, 160}, Shift(2.3, 1.1));
  for (Picture* picture : {&reference, &current}) {
    for (auto& grey : picture->pixels) grey = static_cast<std::uint8_t>(grey / 2);
  }
  Picture brighter = current;
  for (auto& grey : brighter.pixels) grey = static_cast<std::uint8_t>(grey + 120);
  const PhaseCorrelationSettings settings = Settings(128, 128, {{10, 20}});
  const TilePeak same = Run(settings, {"", reference, current})[0];
  const TilePeak other = Run(settings, {"", reference, brighter})[0];
  EXPECT_TRUE(same.valid && other.valid);
  EXPECT_NEAR(same.dx, other.dx, 1e-3);
  EXPECT_NEAR(same.dy, other.dy, 1e-3);
  EXPECT_NEAR(same.height, other.height, 1e-3 * same.height);
}

TEST_P(PhaseCorrelationPropertyTest, CovarianceGrowsAlongMotionBlur) {
  const TilePeak sharp = PeakOfBlurred(0, 0);
  const TilePeak along_x = PeakOfBlurred(8, 0);
  const TilePeak further = PeakOfBlurred(16, 0);
  const TilePeak along_y = PeakOfBlurred(0, 16);
  const TilePeak falling = PeakOfBlurred(11, 11);
  const TilePeak rising = PeakOfBlurred(11, -11);
  for (const TilePeak& peak : {sharp, along_x, further, along_y, falling, rising}) {
    EXPECT_TRUE(peak.valid);
  }
  const auto ratio = [](const TilePeak& peak) { return peak.covariance_xx / peak.covariance_yy; };
  EXPECT_GT(ratio(sharp), 0.5F);
  EXPECT_LT(ratio(sharp), 2.0F);
  EXPECT_GT(ratio(along_x), 1.25F * ratio(sharp));
  EXPECT_GT(ratio(further), 1.25F * ratio(sharp));
  EXPECT_LT(ratio(along_y), 0.8F * ratio(sharp));
  EXPECT_GT(along_x.covariance_xx, sharp.covariance_xx);
  EXPECT_GT(further.covariance_xx, along_x.covariance_xx);
  // Equal shares in x and y; y points down.
  const auto correlation = [](const TilePeak& peak) {
    return peak.covariance_xy / std::sqrt(peak.covariance_xx * peak.covariance_yy);
  };
  EXPECT_NEAR(correlation(sharp), 0.0F, 0.1F);
  EXPECT_GT(correlation(falling), 0.15F);
  EXPECT_LT(correlation(rising), -0.15F);
}

WINDHOVER_TEST_ON_ALL_BACKENDS(PhaseCorrelationPropertyTest);

}  // namespace
}  // namespace windhover
