// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "replay/benchmarks/figures.h"

namespace windhover::replay {

// Legend and a figure for each frame, its views side by side. The picture is in the page once.
// `prefix` makes names unique in it. Empty where there are no samples.
std::string SamplesHtml(const std::vector<SampleFrame>& samples, const std::string& prefix);

}  // namespace windhover::replay
