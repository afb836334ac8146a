// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace windhover::replay {

// Thrown out of long work after Ctrl-C, so that half-written folders are cleaned up on the way out.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

// From now on SIGINT and SIGTERM only set a flag; a second one ends the program at once.
void CatchInterrupts();
// Throws Interrupted once a signal has come.
void ThrowIfInterrupted();

}  // namespace windhover::replay
