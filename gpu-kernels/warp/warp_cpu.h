// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/warp/warp.h"

namespace windhover {

// Runs on the host.
std::unique_ptr<Warp> MakeWarpCpu();

}  // namespace windhover
