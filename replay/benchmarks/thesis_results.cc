// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/thesis_results.h"

#include <algorithm>

#include "replay/benchmarks/dataset.h"

namespace windhover::replay {

std::optional<int> ThesisSequence(const std::string& id) {
  const auto& ten = TenSequences();
  const auto found = std::find(ten.begin(), ten.end(), id);
  if (found == ten.end()) return std::nullopt;
  return static_cast<int>(found - ten.begin());
}

}  // namespace windhover::replay
