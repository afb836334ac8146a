// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "replay/scoring/motion_report.h"
#include "replay/scoring/registration_score.h"
#include "replay/scoring/video_score.h"

namespace windhover::replay {

// Scores for people, each line ended. A figure that there is nothing for is shown as "-".

// All figures of one sequence.
std::string Describe(const MotionReport& report);
// A line for each sequence, their mean and, as `pooled`, all of them together.
std::string MotionTable(std::span<const MotionReport> reports, const MotionReport& pooled);

std::string Describe(const RegistrationScore& score);
struct NamedRegistrationScore {
  std::string name;
  RegistrationScore score;
};
// A line for each sequence and their mean.
std::string RegistrationTable(std::span<const NamedRegistrationScore> scores);

std::string Describe(const VideoScore& score);

}  // namespace windhover::replay
