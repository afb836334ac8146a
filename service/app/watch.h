// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "service/dds/subscriber.h"

namespace windhover {

struct WatchOptions {
  SubscribeOptions subscribe;
  bool json = false;
  bool until_end = false;   // end when every stream seen has ended, at least one
  std::uint64_t count = 0;  // end after that many samples; 0 does not
};

// Prints what is on the bus to the standard output, each line at once, until it is interrupted, the
// output is closed or one of the ends above is reached. Returns the exit code: a failure where
// until_end is asked for and a publisher has gone without a word. Throws DdsError.
int Watch(const WatchOptions& options);

}  // namespace windhover
