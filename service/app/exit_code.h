// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace windhover {

// What the executable answers. Errors are said in one line on the standard error.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;          // wrong arguments or option values
inline constexpr int kExitNotValid = 3;       // register: the registration is degraded or lost
inline constexpr int kExitInterrupted = 130;  // by Ctrl-C or SIGTERM, after a clean end

}  // namespace windhover
