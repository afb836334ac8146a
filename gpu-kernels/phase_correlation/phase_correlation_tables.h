// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "gpu-kernels/phase_correlation/phase_correlation.h"
#include "gpu-kernels/warp/warp_coefficients.h"

namespace windhover {

// A peak is believed where its height is more than this many times the surface's noise. The surface
// of two tiles of pure noise is strongest at small shifts, where the window lets most of both in:
// its highest sample has 5 to 8.5 times the noise in 9 of 10 cases, for tiles of 32 to 128 px.
// Textured tiles reach 30 to 100 times.
inline constexpr float kMinPeakToNoise = 10.0F;
// A tile is believed where the picture covers at least this share of its window weight.
inline constexpr float kMinCoverage = 0.25F;

// What both twins derive from the settings. Throws std::invalid_argument where they are out of
// range.
struct PhaseCorrelationTables {
  explicit PhaseCorrelationTables(const PhaseCorrelationSettings& settings);

  int tile_width;
  int tile_height;
  // Columns of the half spectrum that a real transform yields: tile_width / 2 + 1.
  int spectrum_width;

  // The window's weights, positive and symmetric about (side - 1) / 2; a sample's weight is
  // window_x[x] * window_y[y]. window_sum is the sum over the tile.
  std::vector<float> window_x;
  std::vector<float> window_y;
  float window_sum;

  // Weights of the normalised cross-power spectrum, tile_height x spectrum_width, row-major, bin
  // (0, 0) first: the Gaussian of peak_sigma_px over its sum over all bins of the full spectrum, 0
  // at the zero frequency. An inverse transform without a factor of its own thus gives a perfect
  // match without shift a peak of exactly 1.
  std::vector<float> spectral_weight;

  // Added to the cross power's magnitude before it divides the cross power: 64 times the noise
  // power that a bin is expected to have, (noise_sigma^2 + 1/12) * sum of the squared weights of
  // the window, where 1/12 is the power of rounding to whole grey levels. Measured on textures of
  // 128 px: against a factor of 1, 64 halves the error under noise and blur, costs nothing without
  // them, and finds shifts of 30 px that 1 loses.
  float damping;

  // A peak must be higher than this: 1e-4, less where a high noise_sigma damps all peaks. What
  // rounding leaves of a tile without texture makes peaks of 1e-5, which may rise above a noise
  // that is as small; pure noise of 1 grey level makes some of 1e-3, textures of 0.05 and more.
  float min_height;

  // Half side in px of the square about the highest sample that counts as the peak's neighbourhood:
  // 2 + ceil(3 * peak_sigma_px), but at most a quarter of the smaller tile side.
  int peak_radius;
};

// px, in the tile.
struct TileShift {
  float dx = 0.0F;
  float dy = 0.0F;
};

// How a tile samples its picture. Bilinear interpolation shifts fine detail by up to 0.05 px,
// towards the nearer pixel, and where a whole picture is shifted by a fraction of a pixel all tiles
// would be wrong alike. So each tile is sampled up to half a pixel beside where it was asked for,
// such that the pixel in its middle falls on a pixel of the picture: what turns and zooms then
// leave of the error differs in sign from one side of the tile to the other.
struct TileSampling {
  WarpCoefficients picture_from_tile;
  // What is at x in the tile that is sampled belongs at x + shift.
  TileShift shift;
};

TileSampling SampleTileAt(const Matrix3& picture_from_grid, const TileOrigin& origin,
                          int tile_width, int tile_height);

// The neighbourhood of the highest sample of a correlation surface; the first one in row-major
// order where several are equal.
struct PeakNeighbourhood {
  // Where the highest sample lies, 0 <= x < tile_width, 0 <= y < tile_height. Sample (0, 0) is the
  // shift 0; shifts over half a side are negative.
  int x = 0;
  int y = 0;
  // (2 * peak_radius + 1)^2 samples, row-major, the highest one in the middle; the surface
  // continues periodically.
  std::span<const float> samples;
  // Mean of the squares of all samples outside this neighbourhood.
  float mean_square_outside = 0.0F;
};

// The last step of the correlation, for one tile: sub-pixel place, height, footprint, validity.
//
// sub-pixel   the maximum of the quadratic in x, y and xy that fits the logarithms of the 3x3
//             samples about the highest and of all above 0.7 of it, weighted with the squared
//             sample; within +-1 px. Where that has none, or a sample of the 3x3 is not positive,
//             for each axis with l, c, r the highest sample and its two neighbours: eq. 2.19 where
//             all are positive, else the parabola (r - l) / (4 c - 2 l - 2 r); clamped to +-0.5; 0
//             where the denominator is not positive.
// footprint   samples of the neighbourhood above max(3 * noise, height / 16), each weighted with
//             its excess over that; second central moments, plus 1/12 px^2 for a sample's extent.
// covariance  footprint moments times (noise / height)^2, plus 1e-6 px^2 on the diagonal. Agrees
//             within a factor of 3 with the errors measured on textures with noise of sigma 0 to 5
//             and shifts of up to 3 px.
// valid       coverages >= kMinCoverage, height > kMinPeakToNoise * noise and > min_height, and the
//             highest sample not at a shift of exactly half a tile's side. Where not valid for want
//             of a positive height, the offset is 0 and the covariance that of a uniform guess over
//             the tile.
TilePeak MeasurePeak(const PhaseCorrelationTables& tables, const PeakNeighbourhood& peak,
                     float reference_coverage, float current_coverage);

}  // namespace windhover
