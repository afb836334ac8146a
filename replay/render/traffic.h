// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "replay/render/scene.h"
#include "replay/render/trajectory.h"

namespace windhover::replay {

// Everything that moves over a scene: vehicles on its lanes and people on its walks. Everything is
// computed ahead, so that any time can be asked for in any order; more frames change nothing
// before.
class Traffic {
 public:
  // Frames before the first and after the last one for which poses are known.
  static constexpr int kMarginFrames = 12;

  using Vehicle = Trajectory;  // or person; ids from 1

  Traffic(const Scene& scene, double density, int frames, double frame_rate_hz);

  const std::vector<Vehicle>& vehicles() const { return vehicles_; }
  // `time` in frames, between the margins.
  VehiclePose PoseAt(const Vehicle& vehicle, double time) const;

 private:
  std::vector<Vehicle> vehicles_;
};

}  // namespace windhover::replay
