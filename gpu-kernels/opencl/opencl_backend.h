// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/backend.h"
#include "gpu-kernels/opencl/device.h"
#include "gpu-kernels/opencl/program_cache.h"

namespace windhover::opencl {

// Throws DeviceError where the device cannot be opened.
std::shared_ptr<Backend> MakeOpenClBackend(const Device& device, ProgramCache cache,
                                           const StageObserver& observe = {});

}  // namespace windhover::opencl
