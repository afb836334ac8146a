// SPDX-License-Identifier: Apache-2.0
#include "service/vision/tile_layout.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "service/options/option.h"

namespace windhover {
namespace {

constexpr double kStridePerSide = 0.75;  // neighbours overlap by 25 %
constexpr double kMinSidePx = 24.0;
// Sides of up to so many times a power of two are rounded down to it, where that leaves 64 px at
// least. Rounded to the nearest, they cost up to twice the time and are no more exact (640x480,
// 6 x 6 tiles of 128x128 and of 128x64).
constexpr double kRoundedDown = 1.62;
constexpr int kLeastRoundedDown = 64;
constexpr int kMinTransform = 16;
constexpr int kMaxTransform = 512;

// How many tile sides a row of `count` overlapping tiles measures.
double SidesAlong(int count) { return 1.0 + kStridePerSide * (count - 1); }

int RoundToTransform(double side_px, int picture_px) {
  int side = 1 << std::lround(std::log2(side_px));
  if (side > side_px && side > kLeastRoundedDown && side_px < kRoundedDown * side / 2) side /= 2;
  side = std::clamp(side, kMinTransform, kMaxTransform);
  while (side > picture_px && side > kMinTransform) side /= 2;
  return side;
}

int Origin(int index, int count, int side, int picture_px) {
  if (count == 1) return (picture_px - side) / 2;
  return static_cast<int>(
      std::lround(static_cast<double>(index) * (picture_px - side) / (count - 1)));
}

}  // namespace

int TileCount(int columns, int rows, int layers) {
  return columns * rows + (layers > 1 ? (columns - 1) * (rows - 1) : 0);
}

bool FitsTileLayout(int width, int height, int columns, int rows) {
  return width >= kMinSidePx * SidesAlong(columns) && height >= kMinSidePx * SidesAlong(rows);
}

TileLayout UniformTileLayout(int width, int height, int columns, int rows, int layers) {
  const double ideal_width = width / SidesAlong(columns);
  const double ideal_height = height / SidesAlong(rows);
  if (!FitsTileLayout(width, height, columns, rows)) {
    const auto needed = [](int count) {
      return std::to_string(static_cast<int>(std::ceil(kMinSidePx * SidesAlong(count))));
    };
    throw OptionError("frames of " + std::to_string(width) + "x" + std::to_string(height) +
                      " px are too small for " + std::to_string(columns) + "x" +
                      std::to_string(rows) + " tiles: at least " + needed(columns) + "x" +
                      needed(rows) + " px are needed, or fewer tile-columns and tile-rows");
  }
  TileLayout layout;
  layout.tile_width = RoundToTransform(ideal_width, width);
  layout.tile_height = RoundToTransform(ideal_height, height);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      layout.tiles.push_back({Origin(column, columns, layout.tile_width, width),
                              Origin(row, rows, layout.tile_height, height)});
    }
  }
  if (layers == 1) return layout;
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      const TileOrigin& upper_left = layout.tiles[row * columns + column];
      const TileOrigin& lower_right = layout.tiles[(row + 1) * columns + column + 1];
      layout.tiles.push_back(
          {(upper_left.x + lower_right.x) / 2, (upper_left.y + lower_right.y) / 2});
    }
  }
  return layout;
}

}  // namespace windhover
