// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "replay/readers/ground_motion.h"
#include "replay/readers/recording.h"

namespace windhover::replay {

// A recording and how its camera moves.
struct RecordingSummary {
  Recording recording;
  std::optional<CameraStatistics> true_camera;
  std::optional<CameraStatistics> measured_camera;
};

// Several lines for people.
std::string Describe(const RecordingSummary& summary);
// The same for scripts; the README lists the keys.
nlohmann::ordered_json ToJson(const RecordingSummary& summary);

}  // namespace windhover::replay
