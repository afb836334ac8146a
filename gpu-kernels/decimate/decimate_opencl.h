// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/decimate/decimate.h"
#include "gpu-kernels/opencl/context.h"
#include "gpu-kernels/opencl/row_layout.h"

namespace windhover {

// Runs on the context's device. Throws DeviceError.
std::unique_ptr<Decimate> MakeDecimateOpenCl(opencl::Context& context,
                                             const opencl::RowLayout& layout);

}  // namespace windhover
