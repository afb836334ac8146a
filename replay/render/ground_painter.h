// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "replay/render/scene.h"
#include "replay/render/terrain.h"

namespace windhover::replay {

// A horizontal strip of the terrain's raster, while it is painted.
struct Strip {
  Eigen::Vector2d origin;  // of texel (0, 0) of the whole raster, m
  double texel_m = 0.1;
  int width = 0;  // texels
  int first_row = 0;
  int rows = 0;
  std::uint32_t* colours = nullptr;  // of texel (0, first_row)
  Terrain::Height* heights = nullptr;
};

// Unlit colours of everything flat: meadow, plots, roads with their markings.
void PaintGround(const Scene& scene, const Strip& strip);
// Colours and heights of what stands on it: hedges, buildings, trees.
void PaintObjects(const Scene& scene, const Strip& strip);

}  // namespace windhover::replay
