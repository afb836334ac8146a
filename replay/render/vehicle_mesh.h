// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "replay/render/scene.h"
#include "replay/render/traffic.h"

namespace windhover::replay {

// A convex flat piece of a vehicle's skin in the world (x, y, height), with its colour in its
// light.
struct Face {
  std::array<Eigen::Vector3d, 4> corners;
  Colour colour{};
};

// The skin of a vehicle or of a person in mid-stride, without what lies underneath. `sun_share` is
// the share of the sun that reaches it, 0 to 1.
void AppendFaces(const VehicleLook& look, const VehiclePose& pose, const Sun& sun, float sun_share,
                 std::vector<Face>& faces);

// The outline of the shadow that it casts on what it stands on: convex, 6 points.
std::vector<Eigen::Vector2d> ShadowOutline(const VehicleLook& look, const VehiclePose& pose,
                                           const Sun& sun);

// The cloth of a flag in the wind, which has two sides and no shadow worth mentioning.
void AppendFaces(const Flag& flag, double foot_m, const Wind& wind, const Sun& sun, double time_s,
                 std::vector<Face>& faces);

}  // namespace windhover::replay
