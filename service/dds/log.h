// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <spdlog/logger.h>

#include <memory>

namespace windhover {

// The process' logger called "windhover", which writes to the standard error. Made on first use, so
// that a program may register its own under that name before.
std::shared_ptr<spdlog::logger> Log();

}  // namespace windhover
