// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/backend.h"

namespace windhover {

DeviceInfo CpuTwinInfo();

// Host memory and the CPU twins of all operators.
std::shared_ptr<Backend> MakeCpuBackend();

}  // namespace windhover
