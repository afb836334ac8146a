// SPDX-License-Identifier: Apache-2.0
#include "replay/render/traffic.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "replay/render/drivers.h"
#include "replay/render/portable_math.h"
#include "replay/render/walkers.h"

namespace windhover::replay {

Traffic::Traffic(const Scene& scene, double density, int frames, double frame_rate_hz) {
  constexpr double kSettleSeconds = 14;
  const TrafficClock clock = {static_cast<int>(kSettleSeconds * frame_rate_hz),
                              frames + 2 * kMarginFrames + 1, kMarginFrames, 1 / frame_rate_hz};
  vehicles_ = DriveLanes(scene.lanes, density, scene.seed, clock);
  std::vector<Vehicle> people = FollowWalks(scene.walks, density, scene.seed, clock);
  std::move(people.begin(), people.end(), std::back_inserter(vehicles_));
  for (std::size_t i = 0; scene.thermal && i < vehicles_.size(); ++i) {
    Random random(Mix(scene.seed, 0x7E3A + i));
    vehicles_[i].look = ThermalLook(vehicles_[i].look, 0.85, random);
  }
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    vehicles_[i].look = WithContrast(vehicles_[i].look, scene.traffic_contrast);
    vehicles_[i].id = static_cast<std::int64_t>(i) + 1;
  }
}

VehiclePose Traffic::PoseAt(const Vehicle& vehicle, double time) const {
  const double step = time + kMarginFrames;
  const auto last = static_cast<double>(vehicle.poses.size() - 1);
  const double before = std::clamp(std::floor(step), 0.0, last - 1);
  const auto i = static_cast<std::size_t>(before);
  const double share = step - before;
  const VehiclePose& a = vehicle.poses[i];
  const VehiclePose& b = vehicle.poses[i + 1];
  const Eigen::Vector2d forward = (1 - share) * a.forward + share * b.forward;
  // Whoever turns on the spot has no heading half-way.
  return {a.position + share * (b.position - a.position),
          forward.squaredNorm() > 1e-6 ? Eigen::Vector2d(forward.normalized()) : a.forward,
          a.height + share * (b.height - a.height), a.pitch + share * (b.pitch - a.pitch),
          a.phase + share * (b.phase - a.phase)};
}

}  // namespace windhover::replay
