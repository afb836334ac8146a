// SPDX-License-Identifier: Apache-2.0
// Pictures, settings and the fixture that the tests of the phase correlation share.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "gpu-kernels/phase_correlation/phase_correlation.h"
#include "tests/gpu-kernels/operator_test.h"

namespace windhover {

// Ground that can be looked at from anywhere: waves of many directions and lengths of 3 to 80 px.
inline double Ground(double x, double y) {
  double grey = 128.0;
  for (int i = 0; i < 40; ++i) {
    const double angle = 2.399963 * i;  // the golden angle spreads directions evenly
    const double frequency = 2.0 * 3.14159265 / (80.0 * std::pow(3.0 / 80.0, i / 39.0));
    grey += 11.0 * std::sin(frequency * (std::cos(angle) * x + std::sin(angle) * y) + i * i);
  }
  return grey;
}

// What a camera sees whose pixel x shows the ground at ground_from_picture(x).
inline Picture Shot(PictureSize size, const Matrix3& ground_from_picture) {
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

inline Matrix3 Shift(double x, double y) { return {1, 0, x, 0, 1, y, 0, 0, 1}; }

// Turned by 3 degrees, 2 % larger, tilted: inverse of each other.
inline const Matrix3 kTurned = {1.0186, 0.0534, -14.0, -0.0534, 1.0186, 9.5, 1.2e-5, -2.1e-5, 1.0};

inline PhaseCorrelationSettings Settings(int tile_width, int tile_height,
                                         std::vector<TileOrigin> tiles) {
  PhaseCorrelationSettings settings;
  settings.tile_width = tile_width;
  settings.tile_height = tile_height;
  settings.tiles = std::move(tiles);
  return settings;
}

// 5 tiles, an odd number, of which the last ones hang out of a 333 x 251 picture.
inline std::vector<TileOrigin> SomeTiles(int width, int height) {
  return {{7, 5},
          {(333 - width) / 2, (251 - height) / 2},
          {333 - width - 3, 251 - height - 1},
          {-width / 3, 20},
          {333 - width / 2, 251 - height / 2}};
}

inline void ExpectFinite(const TilePeak& peak) {
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

inline std::vector<Pair> AllPairs() {
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

}  // namespace windhover
