// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace windhover {

// How often this thread has called operator new. Linking allocation_count.cc replaces the global
// operators of the program.
std::size_t AllocationCount();

}  // namespace windhover
