// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "replay/scoring/motion_score.h"
#include "replay/scoring/registration_score.h"

namespace windhover::replay {

// One line for people.
std::string Describe(const MotionScore& score, double overlap);
std::string Describe(const RegistrationScore& score);

}  // namespace windhover::replay
