// SPDX-License-Identifier: Apache-2.0
#include "service/vision/reference_blocks.h"

#include <algorithm>

#include "gpu-kernels/multiversion.h"

namespace windhover {
namespace {

constexpr int kMargin = 1;  // px, that the gradient needs

WINDHOVER_MULTIVERSION
void FillPixels(const FloatPicture& picture, std::span<const std::uint8_t> use,
                const ScaledCoordinates& scaled, ReferenceBlock& block) {
  const auto slope = static_cast<float>(0.5 * scaled.px_per_unit);
  block.pixels = 0.0F;
  for (int j = 0; j < kBlockSide; ++j) {
    const int y = block.y + j;
    const float* const row = picture.row(y);
    for (int i = 0; i < kBlockSide; ++i) {
      const int x = block.x + i;
      const int at = j * kBlockSide + i;
      const bool asked = use.empty() || use[static_cast<std::size_t>(y) * picture.width + x] != 0;
      const float taken = asked && row[x] > kDarkest && row[x] < kBrightest ? 1.0F : 0.0F;
      block.use[at] = taken;
      block.value[at] = taken * row[x];
      block.gradient_x[at] = taken * slope * (row[x + 1] - row[x - 1]);
      block.gradient_y[at] = taken * slope * (row[x + picture.width] - row[x - picture.width]);
      block.pixels += taken;
    }
  }
}

// `u` and `v` are the scaled coordinates of the block's columns and rows.
WINDHOVER_MULTIVERSION
void FillProducts(const float* u, const float* v, ReferenceBlock& block) {
  float sums[kDualProducts][kBlockSide] = {};
  for (int j = 0; j < kBlockSide; ++j) {
    float jacobian[kDualParameters][kBlockSide];
    for (int i = 0; i < kBlockSide; ++i) {
      const int at = j * kBlockSide + i;
      const float gx = block.gradient_x[at];
      const float gy = block.gradient_y[at];
      const float radial = -(gx * u[i] + gy * v[j]);
      jacobian[0][i] = block.use[at];
      jacobian[1][i] = block.value[at];
      jacobian[2][i] = gx;
      jacobian[3][i] = gy;
      jacobian[4][i] = gx * u[i];
      jacobian[5][i] = gx * v[j];
      jacobian[6][i] = gy * u[i];
      jacobian[7][i] = gy * v[j];
      jacobian[8][i] = radial * u[i];
      jacobian[9][i] = radial * v[j];
    }
    int product = 0;
    for (int a = 0; a < kDualParameters; ++a) {
      for (int b = a; b < kDualParameters; ++b, ++product) {
        for (int i = 0; i < kBlockSide; ++i) sums[product][i] += jacobian[a][i] * jacobian[b][i];
      }
    }
  }
  for (int product = 0; product < kDualProducts; ++product) {
    float sum = 0.0F;
    for (int i = 0; i < kBlockSide; ++i) sum += sums[product][i];
    block.products[product] = sum;
  }
}

float SquaredSlope(const ReferenceBlock& block, double px_per_unit) {
  double sum = 0.0;
  for (int i = 0; i < kBlockPixels; ++i) {
    sum += block.gradient_x[i] * block.gradient_x[i] + block.gradient_y[i] * block.gradient_y[i];
  }
  return static_cast<float>(sum / (px_per_unit * px_per_unit * block.pixels));
}

void MarkTextured(std::vector<ReferenceBlock>& blocks) {
  constexpr float kShareOfMean = 0.25F;
  float sum = 0.0F;
  for (const ReferenceBlock& block : blocks) sum += block.squared_slope;
  const float least =
      kShareOfMean * sum / static_cast<float>(std::max<std::size_t>(1, blocks.size()));
  for (ReferenceBlock& block : blocks) block.textured = block.squared_slope >= least;
}

}  // namespace

ScaledCoordinates::ScaledCoordinates(int width, int height)
    : centre_x(0.5 * (width - 1)),
      centre_y(0.5 * (height - 1)),
      px_per_unit(0.5 * std::max(width, height)) {}

Eigen::Matrix3d ScaledCoordinates::ScaledFromPx() const {
  const double s = 1.0 / px_per_unit;
  Eigen::Matrix3d m;
  m << s, 0, -s * centre_x, 0, s, -s * centre_y, 0, 0, 1;
  return m;
}

Eigen::Matrix3d ScaledCoordinates::PxFromScaled() const {
  Eigen::Matrix3d m;
  m << px_per_unit, 0, centre_x, 0, px_per_unit, centre_y, 0, 0, 1;
  return m;
}

void CutIntoBlocks(const FloatPicture& picture, std::span<const std::uint8_t> use,
                   ReferenceBlocks& blocks) {
  blocks.scaled = ScaledCoordinates(picture.width, picture.height);
  blocks.width = picture.width;
  blocks.height = picture.height;
  blocks.pixels = 0.0;
  blocks.blocks.clear();
  const int columns = (picture.width - 2 * kMargin) / kBlockSide;
  const int rows = (picture.height - 2 * kMargin) / kBlockSide;
  // What does not fill a block is left out on both sides alike.
  const int left = (picture.width - columns * kBlockSide) / 2;
  const int top = (picture.height - rows * kBlockSide) / 2;
  const ScaledCoordinates& scaled = blocks.scaled;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      ReferenceBlock& block = blocks.blocks.emplace_back();
      block.x = left + column * kBlockSide;
      block.y = top + row * kBlockSide;
      FillPixels(picture, use, scaled, block);
      if (block.pixels == 0.0F) {
        blocks.blocks.pop_back();
        continue;
      }
      float u[kBlockSide];
      float v[kBlockSide];
      for (int i = 0; i < kBlockSide; ++i) {
        u[i] = static_cast<float>((block.x + i - scaled.centre_x) / scaled.px_per_unit);
        v[i] = static_cast<float>((block.y + i - scaled.centre_y) / scaled.px_per_unit);
      }
      FillProducts(u, v, block);
      block.squared_slope = SquaredSlope(block, scaled.px_per_unit);
      blocks.pixels += block.pixels;
    }
  }
  MarkTextured(blocks.blocks);
}

}  // namespace windhover
