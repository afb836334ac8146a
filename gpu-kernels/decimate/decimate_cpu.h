// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/decimate/decimate.h"

namespace windhover {

// Runs on the host.
std::unique_ptr<Decimate> MakeDecimateCpu();

}  // namespace windhover
