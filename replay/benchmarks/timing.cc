// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/timing.h"

#include <algorithm>
#include <cmath>

namespace windhover::replay {

double Quantile(std::vector<double> samples, double share) {
  if (samples.empty()) return 0;
  const double rank = std::ceil(share * static_cast<double>(samples.size()));
  const auto index =
      std::min(samples.size() - 1, static_cast<std::size_t>(std::max(rank, 1.0)) - 1);
  std::nth_element(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(index),
                   samples.end());
  return samples[index];
}

}  // namespace windhover::replay
