// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace windhover::replay {

// Thrown out of long work after Ctrl-C, so that half-written folders are cleaned up on the way out.
class Interrupted : public std::runtime_error {
 public:
  // `state` tells people what is left, where something could be.
  explicit Interrupted(const std::string& state = "")
      : std::runtime_error("interrupted" + (state.empty() ? "" : "; " + state)) {}
};

// From now on SIGINT and SIGTERM only set a flag; a second one ends the program at once.
void CatchInterrupts();
// Throws Interrupted once a signal has come.
void ThrowIfInterrupted();

}  // namespace windhover::replay
