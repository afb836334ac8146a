// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace windhover::replay {

// "WIDTHxHEIGHT", 16 to 8192 px each. Throws std::invalid_argument.
void ParseSize(const std::string& text, int& width, int& height);

}  // namespace windhover::replay
