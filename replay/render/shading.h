// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "replay/render/ray_caster.h"
#include "replay/render/scene.h"
#include "replay/render/terrain.h"

namespace windhover::replay {

// The light that comes from where a ray meets a terrain, at one instant.
class Shading {
 public:
  // `time_s` moves leaves and water.
  Shading(const Scene& scene, const Terrain& terrain, double time_s);

  struct Light {
    Colour colour{};
    float sun = 1;  // share of the sun that reaches the spot
  };
  // `ray` is (dx, dy, drop); `footprint_m` what the ray stands for across, m.
  Light At(const Hit& hit, const Eigen::Vector3d& ray, double footprint_m) const;

 private:
  Light Sampled(double x, double y, int mip) const;
  Light Wall(const Hit& hit, const Eigen::Vector3d& ray) const;
  Light BuildingWall(const Hit& hit, const Building& building, std::uint32_t seed) const;
  Light Beneath(const Hit& hit) const;
  Light Water(const Hit& hit, Light light) const;
  bool InSun(const Eigen::Vector2d& spot, double height) const;

  const Scene& scene_;
  const Terrain& terrain_;
  double time_s_;
  float sun_height_;
};

// What is seen along a ray that meets nothing: (dx, dy, drop).
Colour SkyColour(const Sky& sky, const Eigen::Vector3d& ray, std::uint64_t seed);

// Share of the light that comes from the air between a spot at this distance and the camera, 0
// to 1.
float HazeShare(const Sky& sky, double distance_m);

}  // namespace windhover::replay
