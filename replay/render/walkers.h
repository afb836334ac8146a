// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "replay/render/lane.h"
#include "replay/render/trajectory.h"

namespace windhover::replay {

// People on the walks, alone and in groups: they walk to and fro, stand for a while and turn round.
// `density` groups for each that the walks have. Without ids.
std::vector<Trajectory> FollowWalks(const std::vector<Walk>& walks, double density,
                                    std::uint64_t seed, const TrafficClock& clock);

}  // namespace windhover::replay
