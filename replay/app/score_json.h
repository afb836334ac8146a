// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <span>

#include "replay/app/score_text.h"
#include "replay/scoring/motion_report.h"
#include "replay/scoring/registration_score.h"
#include "replay/scoring/video_score.h"

namespace windhover::replay {

// Scores for scripts, as README.md lists them. What there is nothing for, and what is infinite, is
// null.
nlohmann::ordered_json MotionJson(std::span<const MotionReport> reports, const MotionReport& pooled,
                                  MotionProtocol protocol);
nlohmann::ordered_json RegistrationJson(std::span<const NamedRegistrationScore> scores);
nlohmann::ordered_json VideoJson(const VideoScore& score);

}  // namespace windhover::replay
