// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/difference_threshold/difference_threshold.h"

namespace windhover {

// Runs on the host.
std::unique_ptr<DifferenceThreshold> MakeDifferenceThresholdCpu();

}  // namespace windhover
