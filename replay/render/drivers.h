// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "replay/render/lane.h"
#include "replay/render/trajectory.h"

namespace windhover::replay {

// Vehicles that follow the lanes: each drives as fast as its driver likes and the bends allow,
// keeps its distance to what is in its way (intelligent driver model, Treiber et al. 2000), and
// stops at red lights and where it has to halt. Crossing traffic of an earlier lane has the right
// of way. `density` vehicles drive for each that the lanes have by their spacing. Without ids.
std::vector<Trajectory> DriveLanes(const std::vector<Lane>& lanes, double density,
                                   std::uint64_t seed, const TrafficClock& clock);

}  // namespace windhover::replay
