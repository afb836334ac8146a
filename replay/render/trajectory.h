// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "replay/render/scene.h"

namespace windhover::replay {

struct VehiclePose {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // of its middle, m
  Eigen::Vector2d forward = Eigen::Vector2d::UnitX();
  double height = 0.0;  // of what it stands on over height 0, m
  double pitch = 0.0;   // rise over a metre ahead, m
  double phase = 0.0;   // people: way walked so far, m
};

// Where a vehicle or a person is at each frame of a time.
struct Trajectory {
  std::int64_t id = 0;
  VehicleLook look;
  std::vector<VehiclePose> poses;
};

// Counts frames of simulation: the first `settle` of `steps` are run, but not kept.
struct TrafficClock {
  int settle = 0;
  int steps = 0;
  int zero = 0;           // the step at which the time is 0 s
  double frame_s = 0.04;  // between two steps
};

}  // namespace windhover::replay
