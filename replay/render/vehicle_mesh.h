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

// The skin of a vehicle, without what lies underneath. `sun_share` is the share of the sun that
// reaches it, 0 to 1.
void AppendFaces(const VehicleLook& look, const VehiclePose& pose, const Sun& sun, float sun_share,
                 std::vector<Face>& faces);

// The outline of the shadow that it casts on the ground: convex, 6 points.
std::array<Eigen::Vector2d, 6> ShadowOutline(const VehicleLook& look, const VehiclePose& pose,
                                             const Sun& sun);

}  // namespace windhover::replay
