// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

namespace windhover::replay {

// Of the values that are there; nothing where none is. The median of an even number of values lies
// halfway between the two in the middle.
struct Summary {
  int count = 0;
  std::optional<double> mean;
  std::optional<double> median;
  std::optional<double> largest;
};
Summary SummaryOf(std::span<const std::optional<double>> values);

}  // namespace windhover::replay
