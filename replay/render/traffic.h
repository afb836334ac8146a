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
};

// Vehicles that follow the lanes of a scene: each drives as fast as its driver likes, keeps its
// distance to the one in front and stops at red lights (intelligent driver model, Treiber et al.
// 2000). Everything is computed ahead, so that any time can be asked for in any order.
class Traffic {
 public:
  // Frames before the first and after the last one for which poses are known.
  static constexpr int kMarginFrames = 12;

  Traffic(const Scene& scene, int frames, double frame_rate_hz);

  struct Vehicle {
    std::int64_t id = 0;  // from 1
    VehicleLook look;
    std::size_t lane = 0;
    // Way along the lane at frames -kMarginFrames, ..., frames + kMarginFrames, m.
    std::vector<float> along;
  };

  const std::vector<Vehicle>& vehicles() const { return vehicles_; }
  // `time` in frames, between the margins.
  VehiclePose PoseAt(const Vehicle& vehicle, double time) const;

 private:
  void FillLane(std::size_t lane, int steps, double frame_s);

  std::vector<Lane> lanes_;
  std::uint64_t seed_;
  std::vector<Vehicle> vehicles_;
};

}  // namespace windhover::replay
