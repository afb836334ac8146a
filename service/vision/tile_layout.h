// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "gpu-kernels/phase_correlation/phase_correlation.h"

namespace windhover {

// Tiles spread evenly over a picture (thesis 2.4.2).
struct TileLayout {
  int tile_width = 0;
  int tile_height = 0;
  std::vector<TileOrigin> tiles;  // row by row, layer by layer
};

// A uniform grid of columns x rows tiles that would overlap by a quarter (thesis 2.4.2) if their
// sides were not rounded to a power of two, which transforms well, rather down than up. The grid
// keeps reaching from border to border, so that the overlap takes up the difference. With two
// layers there is also a tile of the same size centred between each four neighbours: 2 x 2 tiles
// become the thesis' layout of 5, 4 x 4 its 25+. Throws OptionError where tiles would be narrower
// than 24 px before rounding: the text says how large the picture must be.
TileLayout UniformTileLayout(int width, int height, int columns, int rows, int layers = 1);

// Whether UniformTileLayout would not throw.
bool FitsTileLayout(int width, int height, int columns, int rows);

// How many tiles such a layout has.
int TileCount(int columns, int rows, int layers);

}  // namespace windhover
