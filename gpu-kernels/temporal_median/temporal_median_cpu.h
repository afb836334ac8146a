// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/temporal_median/temporal_median.h"

namespace windhover {

// Runs on the host.
std::unique_ptr<TemporalMedian> MakeTemporalMedianCpu();

}  // namespace windhover
