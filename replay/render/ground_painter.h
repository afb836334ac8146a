// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "replay/render/ground_photo.h"
#include "replay/render/scene.h"
#include "replay/render/terrain.h"

namespace windhover::replay {

// A horizontal strip of a terrain's raster, while it is painted.
struct Strip {
  double texel_m = 0.1;
  int width = 0;  // texels
  int rows = 0;
  int first_x = 0;  // texel of the lattice where the strip begins
  int first_y = 0;
  std::uint32_t* colours = nullptr;
  Terrain::Height* heights = nullptr;
  Terrain::Surface* surfaces = nullptr;
  Terrain::Underside* undersides = nullptr;
};

// Unlit colours of everything flat: meadow, plots, roads with their markings; or the photo, unless
// it is null. Heights of the relief.
void PaintGround(const Scene& scene, const GroundPhoto* photo, const Strip& strip);
// What stands on it: hedges, walls, buildings, bridges, canopies, poles, trees.
void PaintObjects(const Scene& scene, const Strip& strip);

}  // namespace windhover::replay
