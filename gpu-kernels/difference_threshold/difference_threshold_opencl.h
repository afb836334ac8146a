// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/difference_threshold/difference_threshold.h"
#include "gpu-kernels/opencl/context.h"
#include "gpu-kernels/opencl/row_layout.h"

namespace windhover {

// Runs on the context's device. Throws DeviceError.
std::unique_ptr<DifferenceThreshold> MakeDifferenceThresholdOpenCl(opencl::Context& context,
                                                                   const opencl::RowLayout& layout);

}  // namespace windhover
