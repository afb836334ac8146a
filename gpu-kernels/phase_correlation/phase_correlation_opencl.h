// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gpu-kernels/opencl/context.h"
#include "gpu-kernels/phase_correlation/phase_correlation.h"

namespace windhover {

// How the kernels are laid out on a device. Changes the speed, not the result.
struct PhaseCorrelationLayout {
  // Rows or columns that one work-item transforms at a time: 1, 2, 4, 8 or 16.
  int lanes = 16;
  // Work-items that look for the peak of one tile together: a power of two, 1 to 256.
  int peak_group = 1;

  static PhaseCorrelationLayout For(const opencl::Context& context);
};

// Runs on the context's device. Throws DeviceError, and std::invalid_argument where settings are
// out of range.
std::unique_ptr<PhaseCorrelation> MakePhaseCorrelationOpenCl(
    opencl::Context& context, const PhaseCorrelationSettings& settings,
    const PhaseCorrelationLayout& layout);

}  // namespace windhover
