// SPDX-License-Identifier: Apache-2.0
#include "replay/scoring/summary.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace windhover::replay {

Summary SummaryOf(std::span<const std::optional<double>> values) {
  std::vector<double> there;
  for (const std::optional<double>& value : values) {
    if (value) there.push_back(*value);
  }
  Summary summary;
  summary.count = static_cast<int>(there.size());
  if (there.empty()) return summary;
  std::sort(there.begin(), there.end());
  const std::size_t middle = there.size() / 2;
  summary.mean = std::accumulate(there.begin(), there.end(), 0.0) / summary.count;
  summary.median = there.size() % 2 == 1 ? there[middle] : (there[middle - 1] + there[middle]) / 2;
  summary.largest = there.back();
  return summary;
}

}  // namespace windhover::replay
