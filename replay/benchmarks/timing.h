// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <vector>

namespace windhover::replay {

using Clock = std::chrono::steady_clock;

inline double Milliseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

// The value that `share` (0 to 1) of the samples do not exceed, by the nearest rank; 0 without
// samples.
double Quantile(std::vector<double> samples, double share);

}  // namespace windhover::replay
