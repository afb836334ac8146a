// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "replay/render/camera.h"
#include "replay/render/flight_plan.h"
#include "replay/render/ground_photo.h"
#include "replay/render/scene.h"
#include "replay/render/terrain.h"

namespace windhover::replay {

// What a flight sees of a scene that stands still: a fine raster near the camera and coarser ones
// beyond. Which one a camera sees at which depth follows from the whole flight; how much of the map
// they cover from the frames that are asked for.
class Land {
 public:
  // For the first `frames` of the flight. `go_on` as Terrain has it.
  Land(const Scene& scene, const FlightPlan& plan, const CameraPath& path, int frames, int threads,
       const std::function<void()>& go_on = {});

  struct Level {
    std::unique_ptr<const Terrain> terrain;
    double end_m = 0;  // how far along the optical axis it is seen
  };
  // From the finest on; at least one.
  const std::vector<Level>& levels() const { return levels_; }
  // Whether the flight sees anything beyond the finest level; if not, the air is clear.
  bool far() const { return far_; }
  // Share of the sun that reaches a spot of the map that is seen at this depth, 0 to 1.
  float SunAt(const Eigen::Vector2d& spot, double depth_m) const;

 private:
  std::unique_ptr<const GroundPhoto> photo_;
  std::vector<Level> levels_;
  bool far_ = false;
};

}  // namespace windhover::replay
