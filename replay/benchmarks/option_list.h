// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace windhover::replay {

// The product's default options as name and value, and how many frames of each sequence took part
// ("all" for 0), for a BenchmarkDocument.
std::vector<std::pair<std::string, std::string>> OptionList(int frames);

}  // namespace windhover::replay
