// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace windhover::replay {

// How a long run keeps in touch with people.
struct BenchmarkProgress {
  std::function<void(const std::string&)> say;  // gets a line now and then
  std::function<void()> check;                  // called often; may throw to end the run
};

}  // namespace windhover::replay
