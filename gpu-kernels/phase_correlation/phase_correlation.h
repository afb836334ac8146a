// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "gpu-kernels/image.h"
#include "gpu-kernels/matrix3.h"

namespace windhover {

// Top left corner of a tile, in px of the reference grid.
struct TileOrigin {
  int x = 0;
  int y = 0;
};

// What fades a tile out towards its border before the transform (thesis 2.4.4), along each axis.
enum class TileWindow {
  kNone,
  kBlackman,  // alpha as in the exact Blackman window, 0 to 0.25
  kCosine,    // half a period; alpha says nothing
  kGaussian,  // alpha: standard deviation as a share of the side, over 0
  kTukey,  // alpha: share of the side that stays flat between two tapers of half a cosine, 0 to 1
};

struct PhaseCorrelationSettings {
  // Tile sides in px: powers of two, 16 to 512, the same for all tiles.
  int tile_width = 128;
  int tile_height = 128;
  // 1 to 1024 tiles. They may overlap and may reach outside the grid's picture.
  std::vector<TileOrigin> tiles;
  TileWindow window = TileWindow::kBlackman;
  float window_alpha = 0.16F;  // thesis 2.4.4
  // Standard deviation in px that a perfect match's peak shall have, 0 to 4: the normalised
  // cross-power spectrum is weighted with the Gaussian that gives it. Makes the log-quadratic fit
  // (eq. 2.19) exact and keeps the noisy high frequencies out. 0 is the thesis as written.
  float peak_sigma_px = 0.8F;
  // Standard deviation of the sensor's noise in grey levels, > 0: frequencies whose magnitude does
  // not rise above what such noise makes are damped instead of being whitened, and a tile without
  // texture gives no peak instead of a random one.
  float noise_sigma = 1.0F;
};

// Where the correlation of one tile pair peaks.
struct TilePeak {
  // What lies at x in the reference tile lies at x + (dx, dy) in the current tile, px, each within
  // half a tile's side.
  float dx = 0.0F;
  float dy = 0.0F;
  // Covariance of (dx, dy) in px^2: second moments of the peak's footprint above the noise
  // threshold, over the squared ratio of its height to the noise.
  float covariance_xx = 0.0F;
  float covariance_xy = 0.0F;
  float covariance_yy = 0.0F;
  // Value of the peak; 1 for a perfect match of a fully textured tile when peak_sigma_px is 0, in
  // units of that perfect peak otherwise.
  float height = 0.0F;
  // Root mean square of the correlation surface away from the peak, in the same units.
  float noise = 0.0F;
  // Share of the tile's window weight, 0 to 1, for which the current picture has pixels.
  float coverage = 0.0F;
  // False when there is no peak: no texture, coverage under 1/4 on either side, a peak not above
  // 10 times the noise, or one at the wrap-around edge. All other fields are finite even then.
  bool valid = false;
};

// The windowed spectra of all tiles of one picture. Made by, and for, one PhaseCorrelation.
class TileSpectra {
 public:
  virtual ~TileSpectra() = default;
};

// Phase correlation of tile pairs (thesis 2.4.1, 2.4.2): window, transform, normalised cross-power
// spectrum (eq. 2.18), inverse transform, peak at sub-pixel accuracy (eq. 2.19), its footprint.
//
// The reference tiles lie at `tiles` on the reference grid. A current picture is sampled on that
// same grid through a predicted homography, so that what is left to measure is small, and a kept
// reference's spectra serve any number of current pictures.
//
// transform    pixel x of a tile is the picture at picture_from_grid(origin + x), bilinear; samples
//              outside the picture count as the tile's mean. The window-weighted mean is taken off
//              before windowing.
// sub-pixel    a quadratic in x, y and xy through the logarithms of the samples about the peak, as
//              peaks of any direction need it, within +-1 px; else eq. 2.19 along each axis; where
//              a neighbour is not positive, a parabola through the values, within +-0.5 px (thesis
//              errata: never NaN).
// twins        valid flags agree except at thresholds; offsets of valid peaks within 0.02 px.
// errors       settings out of range, spectra of another operator: std::invalid_argument
class PhaseCorrelation {
 public:
  virtual ~PhaseCorrelation() = default;

  virtual const PhaseCorrelationSettings& settings() const = 0;
  virtual std::unique_ptr<TileSpectra> MakeSpectra() const = 0;

  virtual void Transform(const GrayImage& picture, const Matrix3& picture_from_grid,
                         TileSpectra& spectra) = 0;

  // `peaks` has one element a tile, in the order of the settings.
  virtual void Correlate(const TileSpectra& reference, const TileSpectra& current,
                         std::span<TilePeak> peaks) = 0;
};

}  // namespace windhover
