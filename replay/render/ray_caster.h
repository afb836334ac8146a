// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "replay/render/terrain.h"

namespace windhover::replay {

// Where a ray meets a terrain.
struct Hit {
  enum class Kind {
    kNone,    // nowhere within the raster and the range
    kTop,     // a surface from above
    kWall,    // a side, or an underside from below
    kBeneath  // the ground under a bridge or a crown
  };
  Kind kind = Kind::kNone;
  double depth = 0;  // lengths of the direction
  // Place on the lattice: texel i reaches from i to i + 1 here.
  double x = 0;
  double y = 0;
  float height = 0;       // m
  std::size_t texel = 0;  // index in the raster
};

// Follows straight lines from one point through a terrain: texels are columns with flat tops. All
// arithmetic is relative to the point, so that it comes out the same for any rectangle.
class RayCaster {
 public:
  RayCaster(const Terrain& terrain, const Eigen::Vector2d& origin, double height_m);

  // Along origin + depth * direction, where the direction is (dx, dy, drop) in m and the depth goes
  // from `begin` to `end`.
  Hit Cast(const Eigen::Vector3d& direction, double begin, double end) const;

  // Where the direction, which goes down, meets height 0: for places where nothing is higher.
  Hit Ground(const Eigen::Vector3d& direction) const;

  // All rays between four, which are its corners.
  using Beam = std::array<Eigen::Vector3d, 4>;
  // How far from `begin` on, and at most to `end`, no ray of a beam can meet anything.
  struct FreeWay {
    double depth = 0;
    bool flat = false;  // all of the rays meet height 0 before `end` and nothing before
  };
  FreeWay FreeWayOf(const Beam& beam, double begin, double end) const;

 private:
  struct Walk;
  bool Touches(const Beam& beam, double near, double far, double metres) const;
  bool CrossBlock(Walk& walk, Hit& hit) const;
  bool MeetColumn(const Walk& walk, double leave, Hit& hit) const;
  Hit At(const Walk& walk, double depth, float height, Hit::Kind kind) const;

  const Terrain& terrain_;
  double height_;
  double per_metre_;  // texels
  // The origin is `inside` from the corner of texel (base_x, base_y) of the raster.
  double inside_x_;
  double inside_y_;
  int base_x_;
  int base_y_;
  float slope_step_;
};

}  // namespace windhover::replay
