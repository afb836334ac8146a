// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "service/vision/smooth_pyramid.h"

namespace windhover {

// What dual inverse compositional registration knows of a reference picture before any frame comes:
// its pixels, gradients and the products of its Jacobian, in square blocks (thesis eq. 2.15).
//
// The ten parameters of a step are, in this order, bias and gain of the photometric warp and then
// the geometric one's entries: shift x, y, the linear part row by row (minus the identity), and the
// perspective part. A pixel's row of the Jacobian is
//   1, T, gx, gy, gx u, gx v, gy u, gy v, -(gx u + gy v) u, -(gx u + gy v) v
// with its value T, the gradient (gx, gy) and its place (u, v) in scaled coordinates.
inline constexpr int kDualParameters = 10;
inline constexpr int kDualProducts = kDualParameters * (kDualParameters + 1) / 2;
inline constexpr int kBlockSide = 8;  // px
inline constexpr int kBlockPixels = kBlockSide * kBlockSide;

// Scaled coordinates of a picture: from its centre, in units of half its larger side.
struct ScaledCoordinates {
  double centre_x = 0.0;  // px
  double centre_y = 0.0;
  double px_per_unit = 1.0;

  ScaledCoordinates() = default;
  ScaledCoordinates(int width, int height);
  Eigen::Matrix3d ScaledFromPx() const;
  Eigen::Matrix3d PxFromScaled() const;
};

// Row by row from the top left. A pixel that does not take part has use 0, gradient 0 and value 0.
struct alignas(64) ReferenceBlock {
  std::array<float, kBlockPixels> gradient_x;  // grey levels per scaled unit
  std::array<float, kBlockPixels> gradient_y;
  std::array<float, kBlockPixels> value;
  std::array<float, kBlockPixels> use;  // 0 or 1
  // Sums over the block of the products of the Jacobian's columns: the upper triangle row by row.
  std::array<float, kDualProducts> products;
  int x;  // of the top left pixel, px
  int y;
  float pixels;         // that take part
  float squared_slope;  // mean square of the gradient's length, (grey levels / px)^2
  bool textured;        // has at least an average share of the picture's texture
};

struct ReferenceBlocks {
  ScaledCoordinates scaled;
  int width = 0;
  int height = 0;
  double pixels = 0.0;  // that take part
  std::vector<ReferenceBlock> blocks;
};

// `use` has an entry for each pixel of the picture, row by row, 0 where it does not take part; all
// do where it is empty. Clipped pixels never do. Blocks in which no pixel takes part are left out;
// the picture's border is. Keeps the memory of `blocks`.
void CutIntoBlocks(const FloatPicture& picture, std::span<const std::uint8_t> use,
                   ReferenceBlocks& blocks);

// Whether a smoothed grey value is so near to black or white that it may be clipped.
inline constexpr float kDarkest = 0.75F;
inline constexpr float kBrightest = 254.25F;

}  // namespace windhover
